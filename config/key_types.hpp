#pragma once
// Makers of keys by type: a name, where the value lives, what is allowed, and a sentence of documentation.

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "config/schema.hpp"
#include "config/values.hpp"
#include "core/pose.hpp"

namespace scree::config {

struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< the minimum itself is not allowed

  bool holds(double value) const { return value <= max && (above_min ? value > min : value >= min); }
  std::string text(const char* noun) const;
};

/// A word that stands for a value no user would write as a number ("none", "default").
struct Word {
  std::string text;  ///< empty = there is none
  double value = 0.0;
};

template <class T, class V>
void set_copy(Key<T>& key, Lens<T, V> lens) {
  key.copy = [lens](const T& from, T& to) { lens(to) = view(lens, from); };
}

template <class T>
Key<T> number(std::string name, Lens<T, double> lens, Bounds bounds, std::string doc, Word word = {}) {
  Key<T> key{std::move(name), bounds.text("a number"), std::move(doc), {}, {}, {}, nullptr, {}, false};
  if (!word.text.empty()) key.expected += " or " + word.text;
  key.read = [lens, bounds, word](const YamlNode& node, T& owner) {
    if (!word.text.empty() && read_text(node) == word.text) return lens(owner) = word.value, true;
    const auto value = read_number(node);
    if (!value || !bounds.holds(*value)) return false;
    lens(owner) = *value;
    return true;
  };
  key.write = [lens, word](const T& owner) {
    const double value = view(lens, owner);
    return !word.text.empty() && value == word.value ? word.text : write_number(value);
  };
  set_copy(key, lens);
  return key;
}

template <class T, std::integral V>
Key<T> integer(std::string name, Lens<T, V> lens, Bounds bounds, std::string doc, Word word = {}) {
  Key<T> key{std::move(name), bounds.text("an integer"), std::move(doc), {}, {}, {}, nullptr, {}, false};
  if (!word.text.empty()) key.expected += " or " + word.text;
  key.read = [lens, bounds, word](const YamlNode& node, T& owner) {
    if (!word.text.empty() && read_text(node) == word.text) return lens(owner) = static_cast<V>(word.value), true;
    const auto value = read_integer(node);
    if (!value || !bounds.holds(static_cast<double>(*value))) return false;
    lens(owner) = static_cast<V>(*value);
    return true;
  };
  key.write = [lens, word](const T& owner) {
    const V value = view(lens, owner);
    return !word.text.empty() && value == static_cast<V>(word.value) ? word.text : std::to_string(value);
  };
  set_copy(key, lens);
  return key;
}

template <class T>
Key<T> flag(std::string name, Lens<T, bool> lens, std::string doc) {
  Key<T> key{std::move(name), "true or false", std::move(doc), {}, {}, {}, nullptr, {}, false};
  key.read = [lens](const YamlNode& node, T& owner) {
    const auto value = read_flag(node);
    if (value) lens(owner) = *value;
    return value.has_value();
  };
  key.write = [lens](const T& owner) { return std::string(view(lens, owner) ? "true" : "false"); };
  set_copy(key, lens);
  return key;
}

/// `accepts` checks the text; `expected` says what it wants.
template <class T>
Key<T> text(std::string name, Lens<T, std::string> lens, std::string expected, bool (*accepts)(const std::string&),
            std::string doc) {
  Key<T> key{std::move(name), std::move(expected), std::move(doc), {}, {}, {}, nullptr, {}, false};
  key.read = [lens, accepts](const YamlNode& node, T& owner) {
    const auto value = read_text(node);
    if (!value || !accepts(*value)) return false;
    lens(owner) = *value;
    return true;
  };
  key.write = [lens](const T& owner) { return write_text(view(lens, owner)); };
  set_copy(key, lens);
  return key;
}

template <class T, class V>
Key<T> choice(std::string name, Lens<T, V> lens, std::vector<std::pair<std::string, V>> words, std::string doc) {
  std::string expected;
  for (const auto& [word, value] : words) expected += (expected.empty() ? "one of " : ", ") + word;
  Key<T> key{std::move(name), std::move(expected), std::move(doc), {}, {}, {}, nullptr, {}, false};
  key.read = [lens, words](const YamlNode& node, T& owner) {
    const auto given = read_text(node);
    for (const auto& [word, value] : words) {
      if (given == word) return lens(owner) = value, true;
    }
    return false;
  };
  key.write = [lens, words](const T& owner) {
    for (const auto& [word, value] : words) {
      if (value == view(lens, owner)) return word;
    }
    return std::string();
  };
  set_copy(key, lens);
  return key;
}

/// Seconds as decimal text, exact to the nanosecond.
template <class T>
Key<T> seconds(std::string name, Lens<T, Duration> lens, Bounds bounds_s, std::string doc) {
  Key<T> key{std::move(name), bounds_s.text("seconds"), std::move(doc), {}, {}, {}, nullptr, {}, false};
  key.read = [lens, bounds_s](const YamlNode& node, T& owner) {
    const auto value = read_seconds(node);
    if (!value || !bounds_s.holds(to_seconds(*value))) return false;
    lens(owner) = *value;
    return true;
  };
  key.write = [lens](const T& owner) { return format_seconds(view(lens, owner)); };
  set_copy(key, lens);
  return key;
}

/// x_m y_m z_m qx qy qz qw of a Pose, with the rule that the quaternion has norm 1. The caller normalises.
Schema<Pose> pose_schema(bool required);

}  // namespace scree::config
