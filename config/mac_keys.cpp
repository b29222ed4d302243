#include "config/mac_keys.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <string_view>
#include <system_error>

#include "config/text_file.hpp"
#include "config/values.hpp"

namespace scree::config {
namespace {

constexpr std::size_t kMaxKeys = 2;
constexpr const char* kHidden = "hidden";  // never 64 digits, so a dump does not load with a key that nobody chose

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// What was found instead of 64 digits, without showing any of it; empty when they were there.
std::string decode(std::string_view text, KeySettings& key) {
  if (text == kHidden) return "'hidden', which stands for them in a dump";
  if (text.size() != 2 * key.bytes.size()) return fmt::format("{} characters", text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int digit = hex_digit(text[i]);
    if (digit < 0) return fmt::format("another character at place {}", i + 1);
    key.bytes[i / 2] = static_cast<std::uint8_t>(key.bytes[i / 2] << 4 | digit);
  }
  return {};
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

Flaw flaw_at(const YamlNode& node, std::string expected, std::string found) {
  return {node.line, node.column, std::move(expected), std::move(found)};
}

/// The value of `name` in a map; null when it is not there. Null and `again` when it is there twice.
const YamlNode* member(const YamlNode& map, std::string_view name, bool& again) {
  const YamlNode* found = nullptr;
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i].scalar != name) continue;
    again = again || found != nullptr;
    found = &map.items[i];
  }
  return found;
}

std::optional<Flaw> read_bytes(const YamlNode* hex, const YamlNode* file, KeySettings& key) {
  constexpr const char* kDigits = "64 hexadecimal digits";
  const YamlNode& given = hex != nullptr ? *hex : *file;
  const auto text = read_text(given);
  if (!text) return flaw_at(given, hex != nullptr ? kDigits : "the path of a file", "something else");
  if (hex != nullptr) {
    const std::string wrong = decode(*text, key);
    return wrong.empty() ? std::nullopt : std::optional(flaw_at(given, kDigits, wrong));
  }
  auto read = read_key_file(key.id, *text);
  if (!read) return flaw_at(given, fmt::format("a file of {}", kDigits), read.error().message);
  key = *std::move(read);
  return std::nullopt;
}

std::optional<Flaw> read_key(const YamlNode& node, KeySettings& key) {
  const std::string expected = "a map {id, hex} or {id, file}";
  if (node.kind != YamlNode::Kind::map) return flaw_at(node, expected, "something else");
  bool again = false;
  const YamlNode* const id = member(node, "id", again);
  const YamlNode* const hex = member(node, "hex", again);
  const YamlNode* const file = member(node, "file", again);
  if (again) return flaw_at(node, expected, "one of them twice");
  if (id == nullptr || (hex == nullptr) == (file == nullptr) || node.keys.size() != 2)
    return flaw_at(node, expected, "other members");
  const auto number = read_integer(*id);
  if (!number || *number < 1 || *number > 65535)
    return flaw_at(*id, "an id from 1 to 65535", number ? fmt::format("{}", *number) : "no integer");
  key.id = static_cast<std::uint16_t>(*number);
  return read_bytes(hex, file, key);
}

}  // namespace

std::optional<Flaw> read_keys(const YamlNode& node, std::vector<KeySettings>& keys) {
  const std::string expected = fmt::format("a list of at most {} keys", kMaxKeys);
  if (node.kind != YamlNode::Kind::sequence) return flaw_at(node, expected, "something else");
  if (node.items.size() > kMaxKeys) return flaw_at(node, expected, fmt::format("{}", node.items.size()));
  std::vector<KeySettings> read;
  for (const YamlNode& item : node.items) {
    KeySettings key;
    if (auto flaw = read_key(item, key)) return flaw;
    if (!read.empty() && read.front().id == key.id)
      return flaw_at(item, "another id than the first key's", fmt::format("{} again", key.id));
    read.push_back(std::move(key));
  }
  keys = std::move(read);
  return std::nullopt;
}

std::string write_keys(const std::vector<KeySettings>& keys) {
  std::string text = "[";
  for (const KeySettings& key : keys) {
    if (text.size() > 1) text += ", ";
    text += key.file.empty() ? fmt::format("{{id: {}, hex: {}}}", key.id, kHidden)
                             : fmt::format("{{id: {}, file: {}}}", key.id, write_text(key.file));
  }
  return text + "]";
}

Result<KeySettings> read_key_file(std::uint16_t id, const std::string& file) {
  std::error_code unreadable;
  const auto status = std::filesystem::status(file, unreadable);
  if (!std::filesystem::exists(status))
    return Error{ErrorKind::no_input, fmt::format("{}: expected a key file, found no such file", file)};
  if (!std::filesystem::is_regular_file(status))  // a pipe would keep the loader waiting
    return Error{ErrorKind::bad_data, fmt::format("{}: expected a key file, found no regular file", file)};
  const auto text = read_text_file(file, "a key file");
  if (!text) return text.error();
  KeySettings key;
  key.id = id;
  key.file = file;
  if (const std::string wrong = decode(trimmed(*text), key); !wrong.empty())
    return Error{ErrorKind::bad_data, fmt::format("{}: expected 64 hexadecimal digits, found {}", file, wrong)};
  return key;
}

Key<PublishSettings> mac_keys() {
  using P = PublishSettings;
  Key<P> key{"keys",
             "a list of at most 2 {id: 1 … 65535, hex: 64 digits} or {id, file: PATH}",
             "Keys of the MAC: the first signs, all verify; none = no MAC.",
             {},
             {},
             {},
             nullptr,
             {},
             false};
  key.read = [](const YamlNode& node, P& p) { return !read_keys(node, p.keys); };
  key.write = [](const P& p) { return write_keys(p.keys); };
  key.copy = [](const P& from, P& to) { to.keys = from.keys; };
  key.explain = [](const YamlNode& node) {
    std::vector<KeySettings> keys;
    return read_keys(node, keys);
  };
  return key;
}

}  // namespace scree::config
