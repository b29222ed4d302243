#include "io/point_header.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <vector>

namespace scree::io {
namespace {

constexpr std::uint64_t kMaxPointBytes = 65536;
constexpr std::uint64_t kCompressionLimit = 16;  ///< points per byte of a compressed PCD

using Words = std::vector<std::string_view>;

/// Takes the next line of `head` apart at its blanks; false at the end.
bool next_line(std::string_view& head, Words& words) {
  words.clear();
  const std::size_t end = head.find('\n');
  if (end == std::string_view::npos) return false;
  std::string_view line = head.substr(0, end);
  head.remove_prefix(end + 1);
  constexpr std::string_view kBlanks = " \t\r";
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return true;
    line.remove_prefix(begin);
    const std::size_t length = std::min(line.find_first_of(kBlanks), line.size());
    words.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
}

std::optional<std::uint64_t> unsigned_number(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size() || value > std::numeric_limits<std::uint32_t>::max())
    return std::nullopt;
  return value;
}

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

struct PcdHeader {
  std::size_t fields = 0, types = 0;
  std::vector<std::uint64_t> sizes, counts;  ///< one per field
  std::uint64_t width = 0, height = 1, points = 0;
  std::string_view data;        ///< ascii, binary, binary_compressed
  std::size_t data_offset = 0;  ///< behind the DATA line
  std::size_t data_line = 0;

  std::uint64_t point_bytes() const {
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) total += sizes[i] * (counts.empty() ? 1 : counts[i]);
    return total;
  }
};

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
  for (std::size_t line = 1; next_line(rest, words); ++line) {
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string_view key = words[0];
    if (key == "FIELDS" || key == "COLUMNS") header.fields = words.size() - 1;
    if (key == "TYPE") header.types = words.size() - 1;
    if (key == "SIZE") header.sizes = numbers(words);
    if (key == "COUNT") header.counts = numbers(words);
    if (key == "POINTS" || key == "WIDTH" || key == "HEIGHT") {
      if (const auto checked = check_count(words, 1, limit, name, line); !checked) return checked.error();
      (key == "POINTS" ? header.points : key == "WIDTH" ? header.width : header.height) = *unsigned_number(words[1]);
    }
    if (key != "DATA" || words.size() < 2) continue;
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

Status check_pcd_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name) {
  const auto header = parse_pcd_header(head, file_bytes * kCompressionLimit, name);
  if (!header) return header.error();
  const auto sizes = header->sizes.size(), counts = header->counts.size();
  if (header->fields == 0 || header->types != header->fields || sizes != header->fields ||
      (counts != 0 && counts != header->fields))
    return refused(
        name, header->data_line,
        fmt::format("expected FIELDS with a SIZE, a TYPE and a COUNT for each, found {} fields, {} sizes, {} "
                    "types, {} counts",
                    header->fields, sizes, header->types, counts));
  if (!std::all_of(header->sizes.begin(), header->sizes.end(),
                   [](std::uint64_t size) { return size == 1 || size == 2 || size == 4 || size == 8; }) ||
      !std::all_of(header->counts.begin(), header->counts.end(), [](std::uint64_t n) { return n < kMaxPointBytes; }))
    return refused(name, header->data_line, "expected sizes of 1, 2, 4 or 8 bytes and counts that fit a point");
  if (header->point_bytes() >= kMaxPointBytes)
    return refused(name, header->data_line, fmt::format("expected points of less than {} bytes", kMaxPointBytes));
  if (header->points == 0 || header->width * header->height != header->points)
    return refused(name, header->data_line,
                   fmt::format("expected WIDTH x HEIGHT = POINTS above 0, found {} x {} and {}", header->width,
                               header->height, header->points));
  return check_pcd_data(*header, head, file_bytes, name);
}

Status check_ply_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name) {
  Words words;
  for (std::size_t line = 1; next_line(head, words); ++line) {
    if (line == 1 && (words.empty() || words[0] != "ply")) break;
    if (words.empty()) continue;
    if (words[0] == "end_header") return {};
    if (words[0] != "element" || words.size() < 2) continue;
    if (auto checked = check_count(words, 2, file_bytes, name, line); !checked) return checked;
  }
  return refused(name, 1, "expected a PLY header from 'ply' to 'end_header', found none");
}

}  // namespace scree::io
