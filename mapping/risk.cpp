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

/// A wheel of radius r over a gap of width w < 2r sinks by r − √(r² − w²/4); over a wider one it falls in.
int gap_cells(const VehicleConfig& vehicle, double cell_m) {
  const double r = vehicle.wheel_radius_m, left = std::max(r - vehicle.max_step_m, 0.0);
  return std::max(1, static_cast<int>(std::ceil(2.0 * std::sqrt(r * r - left * left) / cell_m - 1e-9)));
}

}  // namespace

FootprintRisk::FootprintRisk(const RiskConfig& config)
    : config_(config),
      footprints_(footprints(config.vehicle, config.cell_m, config.headings)),
      reach_(reach_cells(footprints_)),
      gap_cells_(gap_cells(config.vehicle, config.cell_m)),
      disc_(disc(config.vehicle.wheel_radius_m / config.cell_m)) {}

/// Step load and tops of a row of one draw. Differences to cells beyond the border count for nothing.
void FootprintRisk::prepare_row(const Grid<float>& draw_m, const BesideHeights& beside, int row, Grid<float>& step,
                                Grid<float>& tops_m) const {
  const int columns = draw_m.columns();
  float* best = step.row(row).data();
  std::fill_n(best, columns, 0.0F);
  for (const CellIndex& offset : disc_) {
    if (row + offset.y < 0 || row + offset.y >= draw_m.rows()) continue;
    const int begin = std::max(0, -offset.x), end = columns - std::max(0, offset.x);
    risk_rows::raise_difference(draw_m.row(row).data() + begin, draw_m.row(row + offset.y).data() + begin + offset.x,
                                end - begin, best + begin);
  }
  const auto scale = static_cast<float>(1.0 / config_.vehicle.max_step_m);
  risk_rows::step_load(beside.relief_m2.row(row).data(), kStepRelief, beside.face_m2.row(row).data(), scale, columns,
                       best);
  for (int column = 0; column < columns; ++column)
    if (sinks(beside.state, row, column)) best[column] = kMostLoad;
  risk_rows::add_peaks(draw_m.row(row).data(), beside.relief_m2.row(row).data(), kPeak * kPeak,
                       beside.face_m2.row(row).data(), columns, tops_m.row(row).data());
}

bool FootprintRisk::sinks(const Grid<CellState>& state, int row, int column) const {
  if (state(row, column) != CellState::possible_drop) return false;
  const auto known = [&](int r, int c) {
    return state.contains(r, c) && (state(r, c) == CellState::measured || state(r, c) == CellState::reconstructed);
  };
  const auto open = [&](int top, int left) {
    for (int r = top; r < top + gap_cells_; ++r)
      for (int c = left; c < left + gap_cells_; ++c)
        if (known(r, c)) return false;
    return true;
  };
  for (int top = row - gap_cells_ + 1; top <= row; ++top)
    for (int left = column - gap_cells_ + 1; left <= column; ++left)
      if (open(top, left)) return true;
  return false;
}

void FootprintRisk::note_unknown_row(const Grid<CellState>& state, int row) {
  for (int column = 0; column < state.columns(); ++column) {
    const CellState of = state(row, column);
    unknown_(row, column) = of == CellState::never_seen || of == CellState::occluded ? 1.0F : 0.0F;
  }
}

void FootprintRisk::risk_block(const std::vector<Grid<float>>& draws_m, int row, int column, int count,
                               Risk& out) const {
  const VehicleConfig& vehicle = config_.vehicle;
  const risk_rows::Limits limits{static_cast<float>(1.0 / std::tan(vehicle.max_pitch_rad)),
                                 static_cast<float>(1.0 / std::tan(vehicle.max_roll_rad)),
                                 static_cast<float>(1.0 / vehicle.clearance_m), kMostLoad,
                                 1.0F / (std::sqrt(12.0F) * kModelError)};
  float *worst = out.worst.row(row).data() + column, *tail = out.tail.row(row).data() + column;
  std::fill_n(worst, count, 0.0F);
  std::fill_n(tail, count, 0.0F);
  std::fill_n(out.on_unknown.row(row).data() + column, count, 0.0F);
  // draw by draw, so that its rows stay in the first cache for all headings (docs/mapping.md)
  constexpr std::size_t kTogether = 8;
  std::array<risk_rows::Sums, kTogether> sums;
  for (std::size_t first = 0; first < footprints_.size(); first += kTogether) {
    const std::size_t headings = std::min(kTogether, footprints_.size() - first);
    for (std::size_t h = 0; h < headings; ++h) sums[h].clear();
    for (std::size_t k = 0; k < draws_m.size(); ++k)
      for (std::size_t h = 0; h < headings; ++h)
        risk_rows::add_loads(footprints_[first + h], limits, {draws_m[k], tops_m_[k], steps_[k]}, row, column, count,
                             sums[h]);
    for (std::size_t h = 0; h < headings; ++h) {
      risk_rows::finish(sums[h], static_cast<int>(draws_m.size()), kModelError, count,
                        out.sector[first + h].row(row).data() + column, worst, tail);
      risk_rows::raise_under_wheels(footprints_[first + h], unknown_, row, column, count,
                                    out.on_unknown.row(row).data() + column);
    }
  }
}

/// Pieces that begin at the first cell that is asked for and not yet done.
void FootprintRisk::risk_row(const std::vector<Grid<float>>& draws_m, const Grid<std::uint8_t>& asked, int row,
                             Risk& out) const {
  const auto cells = asked.row(row);
  const int end = static_cast<int>(cells.size()) - reach_;
  for (int column = reach_; column < end;) {
    if (cells[static_cast<std::size_t>(column)] == 0) {
      ++column;
      continue;
    }
    int last = std::min(column + risk_rows::kBlock, end);
    while (cells[static_cast<std::size_t>(last) - 1] == 0) --last;
    risk_block(draws_m, row, column, last - column, out);
    column = last;
  }
}

void FootprintRisk::update(const std::vector<Grid<float>>& draws_m, const BesideHeights& beside,
                           const Grid<std::uint8_t>& asked, Executor& executor, Risk& out) {
  const int rows = asked.rows(), columns = asked.columns();
  out.sector.resize(footprints_.size());
  for (Grid<float>& grid : out.sector) grid.assign(rows, columns, kUnknown);
  for (Grid<float>* grid : {&out.worst, &out.tail, &out.on_unknown}) grid->assign(rows, columns, kUnknown);
  if (rows <= 2 * reach_ || columns <= 2 * reach_) return;
  for (std::vector<Grid<float>>* grids : {&steps_, &tops_m_}) {
    grids->resize(draws_m.size());
    for (Grid<float>& grid : *grids) grid.reshape(rows, columns);
  }
  unknown_.reshape(rows, columns);
  const auto prepare = [&](int begin, int end) {
    for (int row = begin; row < end; ++row) note_unknown_row(beside.state, row);
    for (std::size_t k = 0; k < draws_m.size(); ++k)
      for (int row = begin; row < end; ++row) prepare_row(draws_m[k], beside, row, steps_[k], tops_m_[k]);
  };
  for_rows(executor, rows, prepare);
  const auto risks = [&](int begin, int end) {
    for (int row = begin; row < end; ++row) risk_row(draws_m, asked, row + reach_, out);
  };
  for_rows(executor, rows - 2 * reach_, risks);
}

}  // namespace scree::mapping
