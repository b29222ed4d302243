#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::bench {

/// The value that a share q of them stays at or below; NaN of none.
template <class T>
double quantile(std::vector<T> values, double q) {
  if (values.empty()) return std::nan("");
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

}  // namespace scree::bench
