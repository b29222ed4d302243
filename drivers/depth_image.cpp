#include "drivers/depth_image.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "core/simd.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

bool is_blank(std::uint8_t c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// Skips blanks and comments, then reads an unsigned decimal; -1 where there is none or it exceeds `limit`.
int take_number(std::span<const std::uint8_t> bytes, std::size_t& offset, int limit) {
  while (offset < bytes.size() && (is_blank(bytes[offset]) || bytes[offset] == '#')) {
    if (bytes[offset] == '#')
      while (offset < bytes.size() && bytes[offset] != '\n') ++offset;
    else
      ++offset;
  }
  const std::size_t begin = offset;
  int value = 0;
  for (; offset < bytes.size() && bytes[offset] >= '0' && bytes[offset] <= '9'; ++offset) {
    value = value * 10 + (bytes[offset] - '0');
    if (value > limit) return -1;
  }
  return offset == begin ? -1 : value;
}

struct Header {
  int rows = 0;
  int columns = 0;
  int max_value = 0;
  std::size_t payload_offset = 0;
};

Result<Header> parse_header(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto refused = [&](std::string_view expected, std::size_t offset) {
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected {}, found something else at byte {}", name, expected, offset)};
  };
  if (bytes.size() < 3 || bytes[0] != 'P' || bytes[1] != '5' || !(is_blank(bytes[2]) || bytes[2] == '#'))
    return refused("a binary PGM ('P5')", 0);
  Header header;
  std::size_t offset = 2;
  std::size_t begin = offset;
  header.columns = take_number(bytes, offset, kDepthImageMaxSide);
  if (header.columns < 1) return refused(fmt::format("a width of 1..{}", kDepthImageMaxSide), begin);
  begin = offset;
  header.rows = take_number(bytes, offset, kDepthImageMaxSide);
  if (header.rows < 1) return refused(fmt::format("a height of 1..{}", kDepthImageMaxSide), begin);
  begin = offset;
  header.max_value = take_number(bytes, offset, 65535);
  if (header.max_value < 256) return refused("16-bit samples (a maxval of 256..65535)", begin);
  if (offset >= bytes.size() || !is_blank(bytes[offset])) return refused("one blank behind maxval", offset);
  header.payload_offset = offset + 1;
  return header;
}

SCREE_CLONES std::uint16_t unpack(const std::uint8_t* bytes, std::size_t count, std::uint16_t* values) {
  std::uint16_t largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::uint16_t>((bytes[2 * i] << 8) | bytes[2 * i + 1]);
    values[i] = value;
    largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace

Status parse_depth_image(std::span<const std::uint8_t> bytes, const std::string& name, Grid<std::uint16_t>& raw) {
  const auto header = parse_header(bytes, name);
  if (!header) return header.error();
  const std::size_t pixels = static_cast<std::size_t>(header->rows) * static_cast<std::size_t>(header->columns);
  const std::size_t found = bytes.size() - header->payload_offset;
  if (found != 2 * pixels)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected {} x {} samples of 2 bytes = {} bytes from byte {}, found {}{}", name,
                             header->columns, header->rows, 2 * pixels, header->payload_offset, found,
                             found < 2 * pixels ? ": the file is truncated" : "")};
  raw.assign(header->rows, header->columns, 0);
  if (unpack(bytes.data() + header->payload_offset, pixels, raw.data()) <= header->max_value) return {};
  std::size_t i = 0;
  while (raw[i] <= header->max_value) ++i;
  return Error{ErrorKind::bad_data, fmt::format("{}: expected samples up to maxval {}, found {} at byte {}", name,
                                                header->max_value, raw[i], header->payload_offset + 2 * i)};
}

Result<Grid<std::uint16_t>> read_depth_image(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (const auto read = io::read_bytes(file, kDepthImageMaxBytes, bytes); !read) return read.error();
  Grid<std::uint16_t> raw;
  if (const auto parsed = parse_depth_image(bytes, file.string(), raw); !parsed) return parsed.error();
  return raw;
}

Result<std::vector<std::uint8_t>> encode_depth_image(const Grid<std::uint16_t>& raw) {
  if (raw.rows() < 1 || raw.columns() < 1 || raw.rows() > kDepthImageMaxSide || raw.columns() > kDepthImageMaxSide)
    return Error{ErrorKind::bad_data,
                 fmt::format("depth image to write: expected 1..{} rows and columns, found {} x {}", kDepthImageMaxSide,
                             raw.rows(), raw.columns())};
  const std::string header = fmt::format("P5\n{} {}\n65535\n", raw.columns(), raw.rows());
  std::vector<std::uint8_t> bytes(header.size() + 2 * raw.size());
  std::copy(header.begin(), header.end(), bytes.begin());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    bytes[header.size() + 2 * i] = static_cast<std::uint8_t>(raw[i] >> 8);
    bytes[header.size() + 2 * i + 1] = static_cast<std::uint8_t>(raw[i] & 0xFF);
  }
  return bytes;
}

}  // namespace scree::drivers
