#include "drivers/checksum.hpp"

#include <zlib.h>

namespace scree::drivers {

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

std::uint32_t PartialChecksums::crc(std::span<const std::uint8_t> part, std::uint64_t at) {
  if (marks_.empty() || at > known_end()) {
    marks_.assign(1, 0);
    marks_at_ = at;
  }
  forget_before(at);
  const std::uint64_t end = at + part.size();
  const std::size_t first = (at - marks_at_ + kPitch - 1) / kPitch;  // mark at or after the beginning
  const std::uint64_t first_at = marks_at_ + first * kPitch;
  if (first_at > end) return grow(0, part);
  while (known_end() + kPitch <= end) marks_.push_back(grow(marks_.back(), part.subspan(known_end() - at, kPitch)));
  const std::size_t last = (end - marks_at_) / kPitch;  // mark at or before the end
  const std::uint32_t to_end = grow(marks_[last], part.subspan(marks_at_ + last * kPitch - at));
  // zlib: crc(A then B) = combine(crc(A), crc(B), |B|) = combine(crc(A), 0, |B|) ^ crc(B)
  const auto behind = static_cast<z_off_t>(end - first_at);
  const auto rest = static_cast<std::uint32_t>(to_end ^ crc32_combine(marks_[first], 0, behind));
  return static_cast<std::uint32_t>(crc32_combine(grow(0, part.first(first_at - at)), rest, behind));
}

std::uint32_t PartialChecksums::grow(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  bytes_read_ += bytes.size();
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

/// Half of the marks at a time, so that it costs no more than making them did.
void PartialChecksums::forget_before(std::uint64_t at) {
  const std::size_t past = (at - marks_at_) / kPitch;
  if (2 * past < marks_.size()) return;
  marks_.erase(marks_.begin(), marks_.begin() + static_cast<std::ptrdiff_t>(past));
  marks_at_ += past * kPitch;
}

}  // namespace scree::drivers
