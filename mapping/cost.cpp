#include "mapping/cost.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/snapshot.hpp"

namespace scree::mapping {

std::uint8_t cell_cost(const CellRisk& cell, const CostConfig& config) {
  if (cell.state == CellState::possible_drop) return kCostLethal;
  if (cell.state != CellState::measured && cell.state != CellState::reconstructed) return kCostUnknown;
  if (!std::isfinite(cell.risk) || !std::isfinite(cell.tail)) return kCostUnknown;
  const auto risk = static_cast<double>(cell.risk), tail = std::min(static_cast<double>(cell.tail), 1.0);
  if (risk >= config.lethal_risk) return kCostLethal;
  const auto scaled = static_cast<std::uint8_t>(std::lround(kCostMax * (risk + (1.0 - risk) * 0.5 * tail * tail)));
  const bool unmeasured = cell.state == CellState::reconstructed || cell.on_unknown;
  const std::uint8_t of_state = unmeasured ? config.unmeasured_floor : kCostFree;
  return std::max({scaled, of_state, cell.roughness_known ? kCostFree : kUnknownRoughnessFloor});
}

std::uint8_t guarded_cost(CellState state, std::uint8_t verdict, bool& lethal) {
  if (state == CellState::measured && verdict != kCostUnknown) lethal = verdict == kCostLethal;
  return lethal && verdict != kCostLethal ? kCostUnknown : verdict;
}

}  // namespace scree::mapping
