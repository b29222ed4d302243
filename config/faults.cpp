#include "config/faults.hpp"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <numeric>
#include <utility>

namespace scree::config {
namespace {

/// Edits (insert, delete, replace) that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

void Faults::add(const Position& at, std::string_view key, std::string_view expected, std::string_view found) {
  const std::string where = at.line > 0 ? fmt::format("{}:{}:{}", at.name, at.line, at.column) : at.name;
  add_message(fmt::format("{}: {}: expected {}, found {}", where, key, expected, found), key);
}

void Faults::add_message(std::string message, std::string_view key) {
  keys_.emplace(key);
  if (full())
    ++unreported_;
  else
    messages_.push_back(std::move(message));
}

bool Faults::about(std::string_view key) const {
  for (std::size_t dot = key.find('.'); dot != std::string_view::npos; dot = key.find('.', dot + 1)) {
    if (keys_.contains(key.substr(0, dot))) return true;
  }
  return keys_.contains(key);
}

Error Faults::to_error(ErrorKind kind) const {
  std::string text = fmt::format("{}", fmt::join(messages_, "\n"));
  if (unreported_ > 0) text += fmt::format("\n… and {} more faults", unreported_);
  return {kind, std::move(text)};
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  if (word.size() > 64) return {};  // no key is that long; keeps hostile input cheap
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 2);
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance || (distance == best_distance && best.empty())) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace scree::config
