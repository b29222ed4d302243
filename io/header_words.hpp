#pragma once
// Text headers of point files, word by word.

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace scree::io {

using Words = std::vector<std::string_view>;

/// Takes the next line of `head` apart at its blanks; false at the end.
inline bool next_line(std::string_view& head, Words& words) {
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

/// An unsigned 32-bit decimal and nothing else.
inline std::optional<std::uint64_t> unsigned_number(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size() || value > std::numeric_limits<std::uint32_t>::max())
    return std::nullopt;
  return value;
}

}  // namespace scree::io
