#pragma once
// What a map made over a survey is held against: the surface that the simulator scanned, and the survey's own points.

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/point_cloud.hpp"
#include "io/raster.hpp"
#include "tests/studies/study.hpp"

namespace scree::study {

constexpr double kFlatSpread_m = 0.2;  ///< a cell whose highest and lowest differ by less has one height

/// Sum, extremes and number of the heights in one cell.
struct Heights {
  double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
  int n = 0;
  void add(double z) {
    sum += z;
    low = std::min(low, z);
    high = std::max(high, z);
    ++n;
  }
  double mean() const { return sum / n; }
  bool flat() const { return n > 0 && high - low < kFlatSpread_m; }
};

/// Bilinear between cell centres, as the simulator defines its surface; NaN outside or where a corner is unknown.
inline double surface_at(const io::Raster& raster, double x_m, double y_m) {
  const double u = (x_m - raster.x_min_m) / raster.cell_m - 0.5;
  const double v = (y_m - raster.y_min_m) / raster.cell_y_m - 0.5;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  const auto& z = raster.height_m;
  if (!z.contains(row, column) || !z.contains(row + 1, column + 1)) return std::nan("");
  const double fu = u - column, fv = v - row;
  return (1 - fv) * ((1 - fu) * z(row, column) + fu * z(row, column + 1)) +
         fv * ((1 - fu) * z(row + 1, column) + fu * z(row + 1, column + 1));
}

/// The scanned surface in each map cell, at 8 × 8 places (half of each patch's nodes lie inside the cell).
inline Grid<Heights> surface_cells(const io::Raster& raster, const Map& map) {
  constexpr int kPlaces = 8;
  Grid<Heights> cells(map.state.rows(), map.state.columns());
  for (int row = 0; row < cells.rows(); ++row)
    for (int column = 0; column < cells.columns(); ++column)
      for (int i = 0; i < kPlaces * kPlaces; ++i) {
        const double x_m = map.x_min_m + (column + (i % kPlaces + 0.5) / kPlaces) * map.cell_m;
        const double y_m = map.y_min_m + (row + (i / kPlaces + 0.5) / kPlaces) * map.cell_m;
        if (const double z = surface_at(raster, x_m, y_m); !std::isnan(z)) cells(row, column).add(z);
      }
  return cells;
}

/// The survey's points in each map cell.
inline Grid<Heights> survey_cells(const io::PointCloud& cloud, const Map& map) {
  Grid<Heights> cells(map.state.rows(), map.state.columns());
  for (const Eigen::Vector4f& p : cloud.points) {
    const Eigen::Vector3d at = p.head<3>().cast<double>() + cloud.origin_m;
    const int column = static_cast<int>(std::floor(at.x() / map.cell_m) - std::round(map.x_min_m / map.cell_m));
    const int row = static_cast<int>(std::floor(at.y() / map.cell_m) - std::round(map.y_min_m / map.cell_m));
    if (cells.contains(row, column)) cells(row, column).add(at.z());
  }
  return cells;
}

/// Whether `accept` holds for every cell of the 3 × 3 around (row, column).
template <class Accept>
bool around(const Grid<Heights>& cells, int row, int column, Accept accept) {
  for (int r = row - 1; r <= row + 1; ++r)
    for (int c = column - 1; c <= column + 1; ++c)
      if (!cells.contains(r, c) || !accept(cells(r, c))) return false;
  return true;
}

}  // namespace scree::study
