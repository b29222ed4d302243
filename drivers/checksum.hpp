#pragma once
// zlib's CRC-32.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scree::drivers {

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);

/// CRCs of many overlapping parts of one stream for about the price of reading it once: that of a part follows from
/// those of the stream up to its two ends, which are kept for every kPitch-th byte.
class PartialChecksums {
 public:
  static constexpr std::size_t kPitch = 256;

  /// That of `part`, which lies at byte `at` of the stream; `at` never goes back. Cost: two combinations (logarithmic),
  /// one reading of what no part before held, and less than 2 · kPitch bytes. Memory: 1/64 of the longest part.
  std::uint32_t crc(std::span<const std::uint8_t> part, std::uint64_t at);

  std::uint64_t bytes_read() const { return bytes_read_; }  ///< for whoever holds it to that cost

 private:
  std::uint64_t known_end() const { return marks_at_ + (marks_.size() - 1) * kPitch; }
  std::uint32_t grow(std::uint32_t crc, std::span<const std::uint8_t> bytes);
  void forget_before(std::uint64_t at);

  std::vector<std::uint32_t> marks_;  ///< [k]: of the stream, from one origin, up to marks_at_ + k · kPitch
  std::uint64_t marks_at_ = 0;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace scree::drivers
