#pragma once
// The declarative description of a set of keys. Loading, dumping, `--set` and the table in docs/configuration.md all
// come from it.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/faults.hpp"
#include "config/yaml.hpp"

namespace scree::config {

/// What is wrong inside a value that is more than a scalar. Line 0: at the value itself.
struct Flaw {
  int line = 0;
  int column = 0;
  std::string expected;
  std::string found;
};

/// One key of a T.
template <class T>
struct Key {
  std::string name;      ///< dotted: "map.cell_m"
  std::string expected;  ///< "a number above 0, at most 10"
  std::string doc;
  std::function<bool(const YamlNode&, T&)> read;    ///< false: the node is not what `expected` says
  std::function<std::string(const T&)> write;       ///< YAML text that `read` takes back
  std::function<void(const T& from, T& to)> copy;   ///< this key's value alone
  std::function<bool(const T&)> applies = nullptr;  ///< empty = always; a key that does not apply must not be given
  std::string applies_to;                           ///< says when, for messages and the table
  bool required = false;
  std::string applies_key = {};  ///< the key that decides it: while that one is faulty nothing is said of this one
  /// For composite values: what exactly `read` did not take.
  std::function<std::optional<Flaw>(const YamlNode&)> explain = nullptr;
};

/// A contradiction between keys: `check` returns {expected, found} when it is there.
struct Contradiction {
  std::string expected;
  std::string found;
};
template <class T>
struct Rule {
  /// All keys that `check` reads. The first one that was given has its position in the message.
  std::vector<std::string> keys;
  std::function<std::optional<Contradiction>(const T&)> check;
};

template <class T>
struct Schema {
  std::vector<Key<T>> keys;
  std::vector<Rule<T>> rules;
};

/// From an owner to one of its members.
template <class T, class U>
using Lens = std::function<U&(T&)>;

template <class T, class U>
const U& view(const Lens<T, U>& lens, const T& owner) {
  return lens(const_cast<T&>(owner));  // NOLINT: lenses only select
}

/// Every key and rule of `inner`, under `prefix` ("sensor."), as keys of the owner.
template <class T, class U>
void append(Schema<T>& outer, const std::string& prefix, const Lens<T, U>& lens, const Schema<U>& inner) {
  for (const auto& key : inner.keys) {
    Key<T> lifted{prefix + key.name, key.expected, key.doc, {}, {}, {}, nullptr, key.applies_to, key.required};
    if (!key.applies_key.empty()) lifted.applies_key = prefix + key.applies_key;
    lifted.read = [read = key.read, lens](const YamlNode& node, T& owner) { return read(node, lens(owner)); };
    lifted.write = [write = key.write, lens](const T& owner) { return write(view(lens, owner)); };
    lifted.explain = key.explain;
    lifted.copy = [copy = key.copy, lens](const T& from, T& to) { copy(view(lens, from), lens(to)); };
    if (key.applies)
      lifted.applies = [applies = key.applies, lens](const T& owner) { return applies(view(lens, owner)); };
    outer.keys.push_back(std::move(lifted));
  }
  for (const auto& rule : inner.rules) {
    Rule<T> lifted;
    for (const auto& name : rule.keys) lifted.keys.push_back(prefix + name);
    lifted.check = [check = rule.check, lens](const T& owner) { return check(view(lens, owner)); };
    outer.rules.push_back(std::move(lifted));
  }
}

/// The same without the type of the owner, bound to one: what the walk over the tree needs.
struct BoundKey {
  std::string name;
  std::string expected;
  std::function<bool(const YamlNode&)> read;
  bool required = false;
  std::function<std::optional<Flaw>(const YamlNode&)> explain;
};

/// Where each key was given; the last of several places wins (`--set` over the file).
using Given = std::vector<std::pair<std::string, Position>>;
const Position* position_of(const Given& given, const std::string& key);

/// Walks the tree: sections, known keys, unknown and duplicate ones, wrong values.
void read_tree(const YamlNode& root, const std::string& file, const std::vector<BoundKey>& keys, Given& given,
               Faults& faults);
/// One `key=value` of the command line; the value is YAML ("[1, 2]" is a list).
void read_assignment(const std::string& assignment, const std::vector<BoundKey>& keys, Given& given, Faults& faults);
/// The required keys that were not given, each at the position of its nearest section.
void require_keys(const YamlNode& root, const std::string& file, const std::vector<BoundKey>& keys, const Given& given,
                  Faults& faults);
/// Nested YAML from dotted names in order.
std::string nest(const std::vector<std::pair<std::string, std::string>>& values);

template <class T>
std::vector<BoundKey> bind(const Schema<T>& schema, T& owner) {
  std::vector<BoundKey> bound;
  bound.reserve(schema.keys.size());
  for (const auto& key : schema.keys)
    bound.push_back({key.name, key.expected, [&key, &owner](const YamlNode& node) { return key.read(node, owner); },
                     key.required, key.explain});
  return bound;
}

/// Keys that do not apply, and the contradictions, as far as the faults found before leave it certain: a rule is
/// skipped when one of its own keys is faulty.
template <class T>
void check_rules(const Schema<T>& schema, const T& owner, const std::string& file, const Given& given, Faults& faults) {
  const Position nowhere{file, 0, 0};
  const Faults before = faults;  // one contradiction does not hide another one of the same key
  for (const auto& key : schema.keys) {
    const Position* at = position_of(given, key.name);
    if (at == nullptr || !key.applies || key.applies(owner)) continue;
    if (key.applies_key.empty() || !before.about(key.applies_key))
      faults.add(*at, key.name, key.applies_to, "another one");
  }
  for (const auto& rule : schema.rules) {
    if (std::any_of(rule.keys.begin(), rule.keys.end(), [&](const auto& key) { return before.about(key); })) continue;
    const auto contradiction = rule.check(owner);
    if (!contradiction) continue;
    const Position* at = nullptr;
    std::string name = rule.keys.front();
    for (const auto& key : rule.keys) {
      if (at != nullptr) break;
      at = position_of(given, key);
      if (at != nullptr) name = key;
    }
    faults.add(at != nullptr ? *at : nowhere, name, contradiction->expected, contradiction->found);
  }
}

/// Every key that applies, as nested YAML.
template <class T>
std::string dump(const Schema<T>& schema, const T& owner) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const auto& key : schema.keys) {
    if (!key.applies || key.applies(owner)) values.emplace_back(key.name, key.write(owner));
  }
  return nest(values);
}

}  // namespace scree::config
