// PLY headers; see point_header.hpp.

#include <array>
#include <fmt/format.h>

#include "io/header_words.hpp"
#include "io/point_header.hpp"

namespace scree::io {
namespace {

constexpr std::array<std::string_view, 16> kTypes{"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                                  "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                                  "float",  "float32", "double", "float64"};

bool is_type(std::string_view word) {
  return std::find(kTypes.begin(), kTypes.end(), word) != kTypes.end();
}

/// Faults of one line, empty where there is none. `element` is the one that properties belong to.
std::string line_fault(const Words& words, std::uintmax_t file_bytes, std::string_view& element, bool& has_vertices) {
  const std::string_view key = words[0];
  if (key == "comment" || key == "obj_info") return {};
  if (key == "format") return words.size() == 3 ? "" : "expected 'format <kind> <version>'";
  if (key == "element") {
    const auto count = words.size() == 3 ? unsigned_number(words[2]) : std::nullopt;
    if (!count) return "expected 'element <name> <count>'";
    if (*count > file_bytes)
      return fmt::format("expected at most {} points in a file of this size, found {}", file_bytes, *count);
    if (words[1] == "vertex" && has_vertices) return "expected one element vertex, found a second";
    element = words[1];
    has_vertices = has_vertices || element == "vertex";
    return {};
  }
  if (key != "property") return "expected a line of a PLY header, found another";
  if (element.empty()) return "expected an element before its properties";
  if (words.size() == 3 && is_type(words[1])) return {};
  if (words.size() != 5 || words[1] != "list" || !is_type(words[2]) || !is_type(words[3]))
    return "expected 'property <type> <name>' or 'property list <type> <type> <name>'";
  return element == "vertex" ? "expected plain properties of a vertex, found a list" : "";
}

}  // namespace

Status check_ply_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name) {
  Words words;
  std::string_view element;
  bool has_vertices = false;
  for (std::size_t line = 1; next_line(head, words); ++line) {
    if (line == 1 && (words.size() != 1 || words[0] != "ply")) break;
    if (line == 1) continue;
    if (words.size() == 1 && words[0] == "end_header" && has_vertices) return {};
    const std::string fault = words.empty() ? "expected a line of a PLY header, found an empty one"
                                            : line_fault(words, file_bytes, element, has_vertices);
    if (!fault.empty()) return Error{ErrorKind::bad_data, fmt::format("{}:{}: {}", name, line, fault)};
  }
  return Error{ErrorKind::bad_data,
               name + ":1: expected a PLY header from 'ply' to 'end_header' with vertices, found none"};
}

}  // namespace scree::io
