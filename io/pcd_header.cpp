// PCD headers; see point_header.hpp.

#include <algorithm>
#include <array>
#include <cstddef>
#include <fmt/format.h>

#include "io/header_words.hpp"
#include "io/point_header.hpp"

namespace scree::io {
namespace {

constexpr std::uint64_t kMaxPointBytes = 65536;
/// The order is part of the format.
constexpr std::array<std::string_view, 10> kKeys{"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                                 "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
constexpr std::uint64_t kCompressionLimit = 16;  ///< points per byte of a compressed PCD

Error refused(const std::string& name, std::size_t line, const std::string& what) {
  return {ErrorKind::bad_data, fmt::format("{}:{}: {}", name, line, what)};
}

/// One number behind the key, at most `limit`.
Status check_count(const Words& words, std::size_t at, std::uint64_t limit, const std::string& name, std::size_t line) {
  const auto count = words.size() > at ? unsigned_number(words[at]) : std::nullopt;
  if (!count) return refused(name, line, fmt::format("expected a count behind '{}'", words[at - 1]));
  if (*count > limit)
    return refused(name, line,
                   fmt::format("expected at most {} points in a file of this size, found {}", limit, *count));
  return {};
}

/// The numbers of SIZE or COUNT.
std::vector<std::uint64_t> numbers(const Words& words) {
  std::vector<std::uint64_t> values;
  for (std::size_t i = 1; i < words.size(); ++i) values.push_back(unsigned_number(words[i]).value_or(kMaxPointBytes));
  return values;
}

Result<PcdHeader> parse_pcd_header(std::string_view head, std::uint64_t limit, const std::string& name) {
  PcdHeader header;
  Words words;
  std::string_view rest = head;
  std::size_t next_key = 0;
  for (std::size_t line = 1; next_line(rest, words); ++line) {
    if (words.empty() || words[0].starts_with('#')) continue;
    for (const std::string_view word : words)
      if (!std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; }))
        return refused(name, line, "expected printable text in a PCD header, found other bytes");
    const std::string_view key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
    const auto place = static_cast<std::size_t>(std::find(kKeys.begin(), kKeys.end(), key) - kKeys.begin());
    if (place == kKeys.size() || place < next_key)
      return refused(name, line, "expected the lines of a PCD header in their order, found another");
    next_key = place + 1;
    if (key == "FIELDS") header.fields.assign(words.begin() + 1, words.end());
    if (key == "TYPE")
      for (std::size_t i = 1; i < words.size(); ++i) header.types.push_back(words[i].size() == 1 ? words[i][0] : '?');
    if (key == "SIZE") header.sizes = numbers(words);
    if (key == "COUNT") header.counts = numbers(words);
    if (key == "POINTS" || key == "WIDTH" || key == "HEIGHT") {
      if (const auto checked = check_count(words, 1, limit, name, line); !checked) return checked.error();
      (key == "POINTS" ? header.points : key == "WIDTH" ? header.width : header.height) = *unsigned_number(words[1]);
    }
    if (key != "DATA") continue;
    if (words.size() != 2 || (words[1] != "ascii" && words[1] != "binary" && words[1] != "binary_compressed"))
      return refused(name, line, "expected 'DATA ascii', 'binary' or 'binary_compressed', found another");
    header.data = words[1];
    header.data_offset = head.size() - rest.size();
    header.data_line = line;
    return header;
  }
  return refused(name, 1, "expected a PCD header that ends in a DATA line, found none");
}

std::uint64_t little_endian_word(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// The bytes that the data must have behind the header, against those that are there.
Status check_pcd_data(const PcdHeader& header, std::string_view head, std::uintmax_t file_bytes,
                      const std::string& name) {
  const std::uint64_t found = file_bytes - header.data_offset;
  const std::uint64_t payload = header.points * header.point_bytes();
  const auto at_data = [&](const std::string& what) { return refused(name, header.data_line, what); };
  if (header.data == "binary" && found < payload)
    return at_data(
        fmt::format("expected {} points of {} bytes = {} bytes from byte {}, found {}: the file is truncated",
                    header.points, header.point_bytes(), payload, header.data_offset, found));
  if (header.data != "binary_compressed") return {};
  const std::string_view sizes = head.substr(header.data_offset);
  if (sizes.size() < 8) return at_data("expected the two sizes of compressed data, found the end of the file");
  if (little_endian_word(sizes.substr(4)) != payload || little_endian_word(sizes) > found - 8)
    return at_data(fmt::format("expected at most {} compressed bytes that make {}, found {} that make {}", found - 8,
                               payload, little_endian_word(sizes), little_endian_word(sizes.substr(4))));
  return {};
}

}  // namespace

std::uint64_t PcdHeader::point_bytes() const {
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) total += sizes[i] * counts[i];
  return total;
}

Result<PcdHeader> check_pcd_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name) {
  auto header = parse_pcd_header(head, file_bytes * kCompressionLimit, name);
  if (!header) return header.error();
  if (header->counts.empty()) header->counts.assign(header->fields.size(), 1);  // the format's default
  const auto fields = header->fields.size(), sizes = header->sizes.size(), counts = header->counts.size();
  if (fields == 0 || header->types.size() != fields || sizes != fields || counts != fields)
    return refused(
        name, header->data_line,
        fmt::format("expected FIELDS with a SIZE, a TYPE and a COUNT for each, found {} fields, {} sizes, {} "
                    "types, {} counts",
                    fields, sizes, header->types.size(), counts));
  for (const std::string& field : header->fields)
    if (!(field[0] == '_' || (field[0] >= 'a' && field[0] <= 'z') || (field[0] >= 'A' && field[0] <= 'Z')))
      return refused(name, header->data_line,
                     fmt::format("expected field names that begin with a letter, found '{}'", field));
  for (std::size_t i = 0; i < fields; ++i) {
    const bool real = header->types[i] == 'F' && (header->sizes[i] == 4 || header->sizes[i] == 8);
    const bool whole =
        (header->types[i] == 'I' || header->types[i] == 'U') &&
        (header->sizes[i] == 1 || header->sizes[i] == 2 || header->sizes[i] == 4 || header->sizes[i] == 8);
    const std::uint64_t count = header->counts[i];
    if ((!real && !whole) || count < 1 || count >= kMaxPointBytes)
      return refused(
          name, header->data_line,
          fmt::format("expected F of 4 or 8 bytes, I or U of 1, 2, 4 or 8, and a count above 0, found field {} "
                      "of {} bytes and count {}",
                      i + 1, header->sizes[i], count));
  }
  if (header->point_bytes() >= kMaxPointBytes)
    return refused(name, header->data_line, fmt::format("expected points of less than {} bytes", kMaxPointBytes));
  if (header->points == 0 || header->width * header->height != header->points)
    return refused(name, header->data_line,
                   fmt::format("expected WIDTH x HEIGHT = POINTS above 0, found {} x {} and {}", header->width,
                               header->height, header->points));
  if (const auto checked = check_pcd_data(*header, head, file_bytes, name); !checked) return checked.error();
  return header;
}

}  // namespace scree::io
