#pragma once
// From what the vehicle risks on a cell to a cost. docs/cost.md tells planner authors what a cost means.

#include <cstdint>

#include "core/cell_state.hpp"

namespace scree::mapping {

struct CostConfig {
  std::uint8_t unmeasured_floor = 64;  ///< ground that was not measured is never cheaper
  double lethal_risk = 0.8;            ///< a probability of violation from which a cell is lethal, (0, 1]
};

/// Measured ground whose roughness nobody could estimate is never cheaper than this.
inline constexpr std::uint8_t kUnknownRoughnessFloor = 32;

struct CellRisk {
  CellState state = CellState::never_seen;
  float risk = 0.0F;  ///< probability of violating a limit at the worst heading; NaN = unknown
  float tail = 0.0F;  ///< load of the worst draws, 1 = a limit
  bool roughness_known = true;
  bool on_unknown = false;  ///< at some heading a wheel stands on ground of which nothing is known
};

/// 255 for never_seen, occluded and cells without a risk; 254 for possible_drop and where the risk reaches
/// lethal_risk; else 252·(P + (1 − P)·min(tail, 1)²/2), rounded: grows with the risk P and with the tail, 0 on ideal
/// ground, 189 for ground that takes all of a limit (P is a half there). Never below the floors above; what has a wheel
/// on unknown ground counts as unmeasured.
std::uint8_t cell_cost(const CellRisk& cell, const CostConfig& config);

/// The cost to publish for a cell whose verdict is `verdict`. `lethal` is the cell's memory: was it lethal when it was
/// last measured? Such a cell that is no longer measured (what stood there has moved, or a lone return was taken back)
/// is unknown until it is measured again and judged: lethal never decays to ground that may be driven on.
std::uint8_t guarded_cost(CellState state, std::uint8_t verdict, bool& lethal);

}  // namespace scree::mapping
