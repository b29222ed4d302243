#include "mapping/risk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/simd.hpp"
#include "mapping/risk_rows.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

std::vector<CellIndex> disc(double radius_cells) {
  std::vector<CellIndex> cells;
  const int reach = std::max(static_cast<int>(radius_cells), 1);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      if ((x != 0 || y != 0) && x * x + y * y <= std::max(radius_cells * radius_cells, 1.0)) cells.push_back({x, y});
  return cells;
}

}  // namespace

FootprintRisk::FootprintRisk(const RiskConfig& config)
    : config_(config),
      footprints_(footprints(config.vehicle, config.cell_m, config.headings)),
      reach_(reach_cells(footprints_)),
      disc_(disc(config.vehicle.wheel_radius_m / config.cell_m)) {}

/// Differences to cells beyond the border count for nothing.
void FootprintRisk::step_row(const Grid<float>& draw_m, const Grid<float>& relief_m2, int row,
                             Grid<float>& step) const {
  const int columns = draw_m.columns();
  float* best = step.row(row).data();
  std::fill_n(best, columns, 0.0F);
  for (const CellIndex& offset : disc_) {
    if (row + offset.y < 0 || row + offset.y >= draw_m.rows()) continue;
    const int begin = std::max(0, -offset.x), end = columns - std::max(0, offset.x);
    risk_rows::raise_difference(draw_m.row(row).data() + begin, draw_m.row(row + offset.y).data() + begin + offset.x,
                                end - begin, best + begin);
  }
  risk_rows::step_load(relief_m2.row(row).data(), static_cast<float>(1.0 / config_.vehicle.max_step_m), columns, best);
}

void FootprintRisk::risk_row(const std::vector<Grid<float>>& draws_m, int row, Risk& out) const {
  const int n = draws_m.front().columns() - 2 * reach_;
  const VehicleConfig& vehicle = config_.vehicle;
  const risk_rows::Limits limits{static_cast<float>(1.0 / std::tan(vehicle.max_pitch_rad)),
                                 static_cast<float>(1.0 / std::tan(vehicle.max_roll_rad)),
                                 static_cast<float>(1.0 / vehicle.clearance_m)};
  float *worst = out.worst.row(row).data() + reach_, *tail = out.tail.row(row).data() + reach_;
  std::fill_n(worst, n, 0.0F);
  std::fill_n(tail, n, 0.0F);
  risk_rows::Sums sums;
  for (int first = 0; first < n; first += risk_rows::kBlock) {
    const int count = std::min(risk_rows::kBlock, n - first), column = reach_ + first;
    for (std::size_t h = 0; h < footprints_.size(); ++h) {
      sums.clear();
      for (std::size_t k = 0; k < draws_m.size(); ++k)
        risk_rows::add_loads(footprints_[h], limits, draws_m[k], steps_[k], row, column, count, sums);
      risk_rows::finish(sums, static_cast<int>(draws_m.size()), kModelError, count,
                        out.sector[h].row(row).data() + column, worst + first, tail + first);
    }
  }
}

void FootprintRisk::update(const std::vector<Grid<float>>& draws_m, const Grid<float>& relief_m2, Executor& executor,
                           Risk& out) {
  const int rows = relief_m2.rows(), columns = relief_m2.columns();
  out.sector.resize(footprints_.size());
  for (Grid<float>& grid : out.sector) grid.assign(rows, columns, kUnknown);
  for (Grid<float>* grid : {&out.worst, &out.tail}) grid->assign(rows, columns, kUnknown);
  if (rows <= 2 * reach_ || columns <= 2 * reach_) return;
  steps_.resize(draws_m.size());
  for (Grid<float>& step : steps_)
    if (step.rows() != rows || step.columns() != columns) step.assign(rows, columns, 0.0F);
  const auto steps = [&](int begin, int end) {
    for (std::size_t k = 0; k < draws_m.size(); ++k)
      for (int row = begin; row < end; ++row) step_row(draws_m[k], relief_m2, row, steps_[k]);
  };
  for_rows(executor, rows, steps);
  const auto risks = [&](int begin, int end) {
    for (int row = begin; row < end; ++row) risk_row(draws_m, row + reach_, out);
  };
  for_rows(executor, rows - 2 * reach_, risks);
}

}  // namespace scree::mapping
