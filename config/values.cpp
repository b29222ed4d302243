#include "config/values.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace scree::config {
namespace {

bool plain(const YamlNode& node) {
  return node.kind == YamlNode::Kind::scalar && !node.quoted && !node.scalar.empty();
}

/// "010" is eight to some readers of YAML and ten to others: no number here starts with a zero before a digit.
bool has_leading_zero(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (has_leading_zero(text)) return std::nullopt;
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> read_number(const YamlNode& node) {
  if (!plain(node)) return std::nullopt;
  const auto value = parse_whole<double>(node.scalar);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> read_integer(const YamlNode& node) {
  if (!plain(node)) return std::nullopt;
  return parse_whole<std::int64_t>(node.scalar);
}

std::optional<bool> read_flag(const YamlNode& node) {
  if (!plain(node)) return std::nullopt;
  if (node.scalar == "true") return true;
  if (node.scalar == "false") return false;
  return std::nullopt;
}

std::optional<std::string> read_text(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar) return std::nullopt;
  return node.scalar;
}

std::optional<std::vector<double>> read_numbers(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::sequence) return std::nullopt;
  std::vector<double> values;
  values.reserve(node.items.size());
  for (const auto& item : node.items) {
    const auto value = read_number(item);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<Duration> read_seconds(const YamlNode& node) {
  if (!plain(node)) return std::nullopt;
  const auto duration = parse_seconds(node.scalar);
  if (!duration) return std::nullopt;
  return *duration;
}

std::string write_number(double value) {
  return fmt::format("{}", value);  // shortest text that reads back to the same double
}

std::string write_text(const std::string& value) {
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string write_numbers(const std::vector<double>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

bool is_ipv4(const std::string& text) {
  std::string_view rest = text;
  for (int part = 0; part < 4; ++part) {
    const std::size_t dot = rest.find('.');
    if ((dot == std::string_view::npos) != (part == 3)) return false;
    const std::string_view digits = rest.substr(0, dot);
    const auto value = parse_whole<int>(digits);
    if (!value || *value < 0 || *value > 255 || digits.size() > 3 || digits[0] == '+' || digits[0] == '-') return false;
    rest.remove_prefix(part == 3 ? rest.size() : dot + 1);
  }
  return true;
}

bool is_endpoint(const std::string& text, int min_port) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || !is_ipv4(text.substr(0, colon))) return false;
  const std::string digits = text.substr(colon + 1);
  const auto port = parse_whole<int>(digits);
  return port && *port >= min_port && *port <= 65535 && digits[0] != '+';
}

}  // namespace scree::config
