#include "drivers/perceptron_file.hpp"

#include <bit>
#include <cstring>
#include <fmt/format.h>

#include "core/simd.hpp"
#include "drivers/perceptron_header.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

constexpr std::size_t kCmuPixels = std::size_t{kCmuSide} * kCmuSide;

/// Shifts instead of a byte swap: the loop then vectorises with plain SSE2.
std::uint32_t from_big_endian(std::uint32_t w) {
  if constexpr (std::endian::native == std::endian::big) return w;
  return (w >> 24) | ((w >> 8) & 0xFF00u) | ((w << 8) & 0xFF0000u) | (w << 24);
}

SCREE_CLONES void unpack_words(const std::uint8_t* bytes, std::size_t count, int shift, std::uint16_t* values) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes + 4 * i, 4);
    values[i] = static_cast<std::uint16_t>((from_big_endian(word) >> shift) & kPerceptronMaxRaw);
  }
}

SCREE_CLONES std::uint16_t unpack_ranges(const std::uint8_t* bytes, std::size_t count, std::uint16_t* values) {
  std::uint16_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::uint16_t>((bytes[2 * i] << 8) | bytes[2 * i + 1]);
    values[i] = value;
    any = static_cast<std::uint16_t>(any | value);
  }
  return any;
}

void decode_words(std::span<const std::uint8_t> payload, int rows, int columns, const RangeFileOptions& options,
                  RangeFile& out) {
  out.raw.assign(rows, columns, 0);
  unpack_words(payload.data(), out.raw.size(), 0, out.raw.data());
  if (options.reflectance_shift == 0) {
    out.reflectance.assign(0, 0, 0);
    return;
  }
  out.reflectance.assign(rows, columns, 0);
  unpack_words(payload.data(), out.raw.size(), options.reflectance_shift, out.reflectance.data());
}

Status decode_ranges(std::span<const std::uint8_t> payload, const std::string& name, RangeFile& out) {
  out.raw.assign(kCmuSide, kCmuSide, 0);
  out.reflectance.assign(0, 0, 0);
  if (unpack_ranges(payload.data(), kCmuPixels, out.raw.data()) <= kPerceptronMaxRaw) return {};
  std::size_t i = 0;
  while (out.raw[i] <= kPerceptronMaxRaw) ++i;
  return Error{ErrorKind::bad_data,
               fmt::format("{}: expected 2-byte ranges 0..4095, found {} at byte {}", name, out.raw[i], 2 * i)};
}

/// An empty file and one of a wrong size read alike: what would have been accepted, and what is there.
Error not_a_range_file(std::span<const std::uint8_t> bytes, const std::string& name) {
  return {ErrorKind::bad_data,
          fmt::format("{}: expected a USF header (first line '<key>: <rows>') or a headerless CMU file of 262144 or "
                      "131072 bytes, found {} bytes without a header at byte 0",
                      name, bytes.size())};
}

}  // namespace

const char* to_string(RangeFileLayout layout) {
  switch (layout) {
    case RangeFileLayout::usf:
      return "USF";
    case RangeFileLayout::cmu_words:
      return "headerless CMU words";
    case RangeFileLayout::cmu_ranges:
      return "headerless CMU ranges";
  }
  return "unknown";
}

Status parse_range_file(std::span<const std::uint8_t> bytes, const std::string& name, const RangeFileOptions& options,
                        RangeFile& out) {
  out.warning.clear();
  if (options.reflectance_shift != 0 && options.reflectance_shift != 12 && options.reflectance_shift != 16)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected reflectance_shift 12, 16 or 0, found {}", name, options.reflectance_shift)};
  if (looks_like_usf(bytes)) {
    const auto header = parse_usf_header(bytes, name, options.lenient);
    if (!header) return header.error();
    out.layout = RangeFileLayout::usf;
    for (std::size_t i = 0; i < out.header.size(); ++i) out.header[i].assign(header->lines[i]);
    out.warning = header->warning;
    decode_words(bytes.subspan(header->payload_offset), header->rows, header->columns, options, out);
    return {};
  }
  for (std::string& line : out.header) line.clear();
  if (bytes.size() == 4 * kCmuPixels) {
    out.layout = RangeFileLayout::cmu_words;
    decode_words(bytes, kCmuSide, kCmuSide, options, out);
    return {};
  }
  if (bytes.size() == 2 * kCmuPixels) {
    out.layout = RangeFileLayout::cmu_ranges;
    return decode_ranges(bytes, name, out);
  }
  return not_a_range_file(bytes, name);
}

Result<RangeFile> read_range_file(const std::filesystem::path& file, const RangeFileOptions& options) {
  std::vector<std::uint8_t> bytes;
  if (const auto read = io::read_bytes(file, kRangeFileMaxBytes, bytes); !read) return read.error();
  RangeFile out;
  if (const auto parsed = parse_range_file(bytes, file.string(), options, out); !parsed) return parsed.error();
  return out;
}

}  // namespace scree::drivers
