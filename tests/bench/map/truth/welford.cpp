#include "tests/bench/map/truth/welford.hpp"

#include <cmath>
#include <limits>

#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {
namespace {

constexpr float kSystematic_m = 0.005F;  // of a mean of returns, for the phase resolver

}  // namespace

WelfordFusion::WelfordFusion(double cell_m, int size_cells)
    : cell_m_(cell_m),
      window_{{-size_cells, -size_cells}, 2 * size_cells, 2 * size_cells},
      cells_(window_.rows, window_.columns) {}

void WelfordFusion::add(const RangeFrame& frame) {
  const GroundLookup known = [this](double x_m, double y_m) -> std::optional<GroundHeight> {
    const CellIndex index = lattice_cell(x_m, y_m, cell_m_);
    if (!window_.contains(index)) return std::nullopt;
    const Cell& cell = cells_(index.y - window_.min.y, index.x - window_.min.x);
    if (cell.hits == 0) return std::nullopt;
    const float variance_m2 = cell.square_m2 / static_cast<float>(cell.hits) + kSystematic_m * kSystematic_m;
    return GroundHeight{static_cast<double>(cell.mean_m), std::sqrt(static_cast<double>(variance_m2))};
  };
  SerialExecutor serial;
  must(converter_.convert(frame, known, serial, points_));
  add(points_);
}

void WelfordFusion::add(const PointFrame& points) {
  const auto per_m = static_cast<float>(1.0 / cell_m_);
  const auto x0 = static_cast<float>(points.anchor_map_m.x() - window_.min.x * cell_m_);
  const auto y0 = static_cast<float>(points.anchor_map_m.y() - window_.min.y * cell_m_);
  const auto z0 = static_cast<float>(points.anchor_map_m.z());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int column = static_cast<int>(std::floor((points.x_m[i] + x0) * per_m));
    const int row = static_cast<int>(std::floor((points.y_m[i] + y0) * per_m));
    if (!cells_.contains(row, column)) continue;
    Cell& cell = cells_(row, column);
    const float z = points.z_m[i] + z0, change = z - cell.mean_m;
    cell.mean_m += change / static_cast<float>(++cell.hits);
    cell.square_m2 += change * (z - cell.mean_m);
  }
}

WelfordMap WelfordFusion::cut(const LatticeWindow& window) const {
  WelfordMap out{window, Grid<float>(window.rows, window.columns, std::numeric_limits<float>::quiet_NaN()),
                 Grid<std::uint32_t>(window.rows, window.columns, 0)};
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column) {
      const int r = row + window.min.y - window_.min.y, c = column + window.min.x - window_.min.x;
      if (!cells_.contains(r, c) || cells_(r, c).hits == 0) continue;
      out.mean_m(row, column) = cells_(r, c).mean_m;
      out.hits(row, column) = cells_(r, c).hits;
    }
  return out;
}

}  // namespace scree::bench
