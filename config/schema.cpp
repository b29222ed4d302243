#include "config/schema.hpp"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <map>
#include <string_view>
#include <utility>

namespace scree::config {
namespace {

/// Walks one document against the keys.
class TreeReader {
 public:
  TreeReader(const std::string& file, const std::vector<BoundKey>& keys, Given& given, Faults& faults)
      : file_(file), keys_(keys), given_(given), faults_(faults) {}

  /// `prefix` is "" or ends in a dot.
  void read_section(const YamlNode& section, const std::string& prefix) {
    std::map<std::string_view, int> first_line;
    for (std::size_t i = 0; i < section.items.size(); ++i) {
      const YamlNode& key = section.keys[i];
      const Position at{file_, key.line, key.column};
      if (key.kind != YamlNode::Kind::scalar) {
        faults_.add(at, prefix.empty() ? "(top)" : prefix.substr(0, prefix.size() - 1), "a key", describe(key));
        continue;
      }
      const std::string name = prefix + key.scalar;
      const auto [first, is_first] = first_line.emplace(key.scalar, key.line);
      if (!is_first) {
        faults_.add(at, name, "each key once", fmt::format("it again (first in line {})", first->second));
        continue;
      }
      read_entry(name, at, section.items[i]);
    }
  }

  void read_entry(const std::string& name, const Position& at, const YamlNode& value) {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const auto& k) { return k.name == name; });
    if (key != keys_.end()) {
      read_value(*key, at, value);
    } else if (is_section(name)) {
      if (value.kind == YamlNode::Kind::map)
        read_section(value, name + ".");
      else if (value.kind != YamlNode::Kind::null)  // an empty section is a section with everything commented out
        faults_.add(at, name, "a section of keys", describe(value));
    } else {
      report_unknown(name, at);
    }
  }

 private:
  void read_value(const BoundKey& key, Position at, const YamlNode& value) {
    given_.emplace_back(key.name, at);
    if (key.read(value)) return;
    if (value.kind != YamlNode::Kind::null && value.line > 0 && at.line > 0) at = {file_, value.line, value.column};
    const auto flaw = key.explain ? key.explain(value) : std::nullopt;
    if (!flaw) return faults_.add(at, key.name, key.expected, describe(value));
    if (flaw->line > 0 && at.line > 0) at = {file_, flaw->line, flaw->column};
    faults_.add(at, key.name, flaw->expected, flaw->found);
  }

  bool is_section(std::string_view name) const {
    return std::any_of(keys_.begin(), keys_.end(), [&](const auto& key) {
      return key.name.size() > name.size() && key.name.starts_with(name) && key.name[name.size()] == '.';
    });
  }

  /// Suggests among the neighbours first: the last part is what people mistype.
  void report_unknown(const std::string& name, const Position& at) {
    if (faults_.full()) return faults_.add(at, name, "a known key", "an unknown one");
    std::vector<std::string> all;
    for (const auto& key : keys_) {
      all.push_back(key.name);
      for (std::size_t dot = key.name.find('.'); dot != std::string::npos; dot = key.name.find('.', dot + 1))
        all.push_back(key.name.substr(0, dot));
    }
    const std::size_t dot = name.rfind('.');
    std::vector<std::string> neighbours;
    const std::string parent = dot == std::string::npos ? "" : name.substr(0, dot + 1);
    for (const auto& key : all) {
      if (key.starts_with(parent))
        neighbours.push_back(key.substr(parent.size(), key.find('.', parent.size()) - parent.size()));
    }
    std::string suggestion = nearest(name.substr(parent.size()), neighbours);
    suggestion = suggestion.empty() ? nearest(name, all) : parent + suggestion;
    faults_.add(at, name, suggestion.empty() ? "a known key" : fmt::format("a known key (nearest: {})", suggestion),
                "an unknown one");
  }

  const std::string& file_;
  const std::vector<BoundKey>& keys_;
  Given& given_;
  Faults& faults_;
};

std::vector<std::string_view> parts_of(std::string_view name) {
  std::vector<std::string_view> parts;
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
    parts.push_back(name.substr(0, dot));
    name.remove_prefix(dot + 1);
  }
  parts.push_back(name);
  return parts;
}

/// "sources[0].kind" → sources, [0], kind: an element of a list is a part of its own.
std::vector<std::string_view> parts_with_elements(std::string_view name) {
  std::vector<std::string_view> parts;
  for (const auto part : parts_of(name)) {
    const std::size_t bracket = part.find('[');
    parts.push_back(part.substr(0, bracket));
    if (bracket != std::string_view::npos) parts.push_back(part.substr(bracket));
  }
  return parts;
}

}  // namespace

const Position* position_of(const Given& given, const std::string& key) {
  const auto last = std::find_if(given.rbegin(), given.rend(), [&](const auto& entry) { return entry.first == key; });
  return last == given.rend() ? nullptr : &last->second;
}

void read_tree(const YamlNode& root, const std::string& file, const std::vector<BoundKey>& keys, Given& given,
               Faults& faults) {
  if (root.kind == YamlNode::Kind::null) return;
  if (root.kind != YamlNode::Kind::map) {
    faults.add({file, root.line, root.column}, "(top)", "a map of sections", describe(root));
    return;
  }
  TreeReader(file, keys, given, faults).read_section(root, "");
}

void read_assignment(const std::string& assignment, const std::vector<BoundKey>& keys, Given& given, Faults& faults) {
  const Position at{"--set", 0, 0};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    faults.add(at, "(assignment)", "key=value", fmt::format("'{}'", assignment));
    return;
  }
  const std::string name = assignment.substr(0, equals);
  const auto value = parse_yaml(std::string_view(assignment).substr(equals + 1), "--set " + name);
  if (!value) {
    faults.add_message(value.error().message, name);
    return;
  }
  TreeReader(at.name, keys, given, faults).read_entry(name, at, *value);
}

void require_keys(const YamlNode& root, const std::string& file, const std::vector<BoundKey>& keys, const Given& given,
                  Faults& faults) {
  for (const auto& key : keys) {
    if (!key.required || position_of(given, key.name) != nullptr) continue;
    Position at{file, 1, 1};
    const YamlNode* node = &root;
    for (const auto part : parts_of(key.name)) {
      const YamlNode* next = nullptr;
      for (std::size_t i = 0; i < node->keys.size(); ++i) {
        if (node->keys[i].scalar != part) continue;
        next = &node->items[i];
        at = {file, node->keys[i].line, node->keys[i].column};
        break;
      }
      if (next == nullptr) break;
      node = next;
    }
    faults.add(at, key.name, key.expected, "no such key");
  }
}

std::string nest(const std::vector<std::pair<std::string, std::string>>& values) {
  std::string text;
  std::vector<std::string_view> open;
  bool dash = false;  // the next line begins an element
  const auto put = [&](std::size_t depth, const std::string& line) {
    const std::string indent(2 * depth, ' ');
    text += std::exchange(dash, false) ? indent.substr(2) + "- " + line : indent + line;
  };
  for (const auto& [name, value] : values) {
    const auto parts = parts_with_elements(name);
    std::size_t common = 0;
    while (common < open.size() && common + 1 < parts.size() && open[common] == parts[common]) ++common;
    open.resize(common);
    for (; common + 1 < parts.size(); ++common) {
      if (parts[common].starts_with('['))
        dash = true;
      else
        put(common, fmt::format("{}:\n", parts[common]));
      open.push_back(parts[common]);
    }
    put(common, fmt::format("{}: {}\n", parts.back(), value));
  }
  return text;
}

}  // namespace scree::config
