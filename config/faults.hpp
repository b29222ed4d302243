#pragma once
// Every fault of a configuration, collected before any is reported.

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace scree::config {

/// Where a value was given. `line` 0: not in a file (`--set`).
struct Position {
  std::string name;
  int line = 0;
  int column = 0;
};

class Faults {
 public:
  /// "file:line:column: key: expected …, found …"
  void add(const Position& at, std::string_view key, std::string_view expected, std::string_view found);
  /// A fault whose message is complete; `key` is what it is about.
  void add_message(std::string message, std::string_view key);

  bool empty() const { return messages_.empty(); }
  /// True when `key` or a section around it is faulty: its value is then not what the user meant.
  bool about(std::string_view key) const;
  /// Enough were found to stop explaining: the rest is only counted.
  bool full() const { return messages_.size() >= kMaxReported; }
  /// One fault a line.
  Error to_error(ErrorKind kind) const;

 private:
  static constexpr std::size_t kMaxReported = 100;
  std::vector<std::string> messages_;
  std::set<std::string, std::less<>> keys_;
  std::size_t unreported_ = 0;
};

/// The candidate with the smallest edit distance to `word`, when it is close enough to be what was meant; else empty.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace scree::config
