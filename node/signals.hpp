#pragma once
// SIGINT and SIGTERM as something to wait for, instead of something that interrupts.

#include <chrono>

namespace scree::node {

/// Make it before any thread, in main's thread: all threads made later inherit the mask.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// True when SIGINT or SIGTERM came within `timeout`.
  bool wait(std::chrono::milliseconds timeout);
  /// From now on a second signal ends the process at once.
  void release();

 private:
  bool blocked_ = true;
};

}  // namespace scree::node
