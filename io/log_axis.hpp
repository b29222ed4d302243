#pragma once
// A logarithmic axis: its limits and its ticks.

#include <vector>

#include "io/picture_layout.hpp"

namespace scree::io {

/// Limits of an axis that holds [low, high] (> 0) with a margin.
struct LogRange {
  double low = 1.0, high = 10.0;
  double share(double value) const;  ///< 0 at low, 1 at high
};

/// 1, 2 … 9 · 10^n within the range. Labels at the decades; at 2 and 5 too where fewer than three decades are in it,
/// and at each of them where not even three of those are.
std::vector<Tick> log_ticks(const LogRange& range);

/// [low, high] (> 0) widened by a share of its length on the logarithmic axis, to a factor of 3 at least: there are
/// ticks to label.
LogRange widened(double low, double high, double share);

}  // namespace scree::io
