#pragma once

#include <functional>

#include "core/executor.hpp"

namespace scree::mapping {

/// `body(begin, end)` over [0, count) without the allocation that a large closure costs inside a std::function.
template <class Body>
void for_rows(Executor& executor, int count, Body&& body) {
  executor.for_ranges(count, std::ref(body));
}

}  // namespace scree::mapping
