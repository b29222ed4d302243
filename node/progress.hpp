#pragma once
// A progress bar on a terminal's stderr; nothing anywhere else.

#include <cstddef>
#include <string>

namespace scree::node {

class Progress {
 public:
  /// `total` 0: unknown, no bar.
  Progress(std::string label, std::size_t total);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::size_t done);
  /// Takes the bar away before something else is printed.
  void clear();

 private:
  std::string label_;
  std::size_t total_;
  bool on_terminal_;
  bool shown_ = false;
};

}  // namespace scree::node
