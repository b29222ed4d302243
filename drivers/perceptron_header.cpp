#include "drivers/perceptron_header.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>

#include "drivers/perceptron_file.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

constexpr std::size_t kMaxSurplus = 4096;

bool is_text(char c) {
  return (c >= ' ' && c <= '~') || c == '\t' || c == '\r' || c == '\n';
}

/// The line at `offset` without its LF or CR LF, and `offset` moved behind it; nothing without an LF in `text`.
std::optional<std::string_view> take_line(std::string_view text, std::size_t& offset) {
  const std::size_t end = text.find('\n', offset);
  if (end == std::string_view::npos) return std::nullopt;
  std::string_view line = text.substr(offset, end - offset);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  offset = end + 1;
  return line;
}

/// For messages: short, printable.
std::string shown(std::string_view line) {
  std::string text(line.substr(0, 40));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return !is_text(c) || c == '\r' || c == '\n'; }, '?');
  return text;
}

/// The value of "<key>: <value>".
Result<int> parse_side(std::string_view line, const char* what, std::size_t offset, const std::string& name) {
  const Error error{ErrorKind::bad_data,
                    fmt::format("{}: expected '<key>: <{}>' with {} in 1..{}, found '{}' at byte {}", name, what, what,
                                kRangeFileMaxSide, shown(line), offset)};
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return error;
  line.remove_prefix(colon + 1);
  while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
  while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
  int value = 0;
  const auto [end, status] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (status != std::errc{} || end != line.data() + line.size() || value < 1 || value > kRangeFileMaxSide) return error;
  return value;
}

/// Places the payload at the end of the file and accounts for every byte between it and the header. Behind surplus text
/// a payload that itself begins like text is refused: in a cut file the end of the text would slide into the payload,
/// and a truncated file is never accepted.
/// `header_end`: behind the tenth line; `empty_line_end`: behind the empty eleventh, where there is one.
Status anchor_payload(std::string_view text, const std::string& name, bool lenient, std::size_t header_end,
                      std::optional<std::size_t> empty_line_end, UsfHeader& header) {
  const std::size_t payload =
      std::size_t{4} * static_cast<std::size_t>(header.rows) * static_cast<std::size_t>(header.columns);
  const std::size_t begin = empty_line_end.value_or(header_end);
  const std::string expected = fmt::format("{} x {} words of 4 bytes = {} bytes", header.rows, header.columns, payload);
  if (text.size() < begin + payload)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected {} from byte {}, found {}: the file is truncated", name,
                                                  expected, begin, text.size() - begin)};
  const std::size_t surplus = text.size() - payload - begin;
  header.payload_offset = text.size() - payload;
  if (surplus == 0 && empty_line_end) return {};
  if (!lenient || surplus < 1 || surplus > kMaxSurplus) {
    if (!empty_line_end)
      return Error{ErrorKind::bad_data,
                   fmt::format("{}: expected an empty line behind the 10 header lines, found '{}' at byte {}", name,
                               shown(text.substr(begin, 16)), begin)};
    return Error{ErrorKind::bad_data, fmt::format("{}: expected {} from byte {}, found {}: {} bytes too many", name,
                                                  expected, begin, text.size() - begin, surplus)};
  }
  const std::string_view between = text.substr(begin, surplus);
  const auto bad = std::find_if_not(between.begin(), between.end(), is_text);
  if (bad != between.end())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected printable text between header and payload, found code {} at byte {}", name,
                             static_cast<int>(static_cast<unsigned char>(*bad)),
                             begin + static_cast<std::size_t>(bad - between.begin()))};
  if (is_text(text[header.payload_offset]))
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a payload at byte {}, found more text: the file is truncated", name,
                             header.payload_offset)};
  header.warning = fmt::format("{}: {} bytes of text at byte {} between header and payload were skipped (lenient)",
                               name, surplus, begin);
  return {};
}

}  // namespace

bool looks_like_usf(std::span<const std::uint8_t> bytes) {
  const std::string_view text = io::as_text(bytes.first(std::min(bytes.size(), kRangeFileMaxHeader)));
  const std::string_view first = text.substr(0, text.find('\n'));
  return first.find(':') != std::string_view::npos && std::all_of(first.begin(), first.end(), is_text);
}

Result<UsfHeader> parse_usf_header(std::span<const std::uint8_t> bytes, const std::string& name, bool lenient) {
  const std::string_view text = io::as_text(bytes);
  const std::string_view head = text.substr(0, kRangeFileMaxHeader);
  UsfHeader header;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < header.lines.size(); ++i) {
    const std::size_t line_begin = offset;
    const auto line = take_line(head, offset);
    if (!line)
      return Error{ErrorKind::bad_data,
                   fmt::format("{}: expected 10 header lines within the first {} bytes, found {} (byte {})", name,
                               kRangeFileMaxHeader, i, line_begin)};
    header.lines[i] = *line;
    if (i > 1) continue;
    const auto side = parse_side(*line, i == 0 ? "rows" : "columns", line_begin, name);
    if (!side) return side.error();
    (i == 0 ? header.rows : header.columns) = *side;
  }
  std::optional<std::size_t> empty_line_end;
  if (std::size_t behind = offset; head.substr(offset, 1) == "\n" || head.substr(offset, 2) == "\r\n") {
    take_line(head, behind);
    empty_line_end = behind;
  }
  if (const auto anchored = anchor_payload(text, name, lenient, offset, empty_line_end, header); !anchored)
    return anchored.error();
  return header;
}

}  // namespace scree::drivers
