#pragma once
// Data parallelism without owning threads: the pipeline hands an Executor to whoever has a loop over rows.

#include <functional>

namespace scree {

/// Runs a loop body over [0, count). The body must write only what belongs to its own index range, so that results do
/// not depend on how the range is cut.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Calls `body(begin, end)` for disjoint ranges that cover [0, count), returns when all are done.
  virtual void for_ranges(int count, const std::function<void(int begin, int end)>& body) = 0;
};

/// `body(begin, end)` over [0, count) without the allocation that a large closure costs inside a std::function.
template <class Body>
void for_rows(Executor& executor, int count, Body&& body) {
  executor.for_ranges(count, std::ref(body));
}

/// Everything on the caller's thread, in one range.
class SerialExecutor final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    if (count > 0) body(0, count);
  }
};

}  // namespace scree
