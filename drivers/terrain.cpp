#include "drivers/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace scree::drivers {
namespace {

Error no_surface(const std::string& name, const std::string& expected, const std::string& found) {
  return {ErrorKind::bad_data, fmt::format("{}: expected {}, found {}", name, expected, found)};
}

}  // namespace

Result<Terrain> Terrain::make(io::Raster raster, const std::string& name) {
  if (raster.geographic) return io::geographic_error(raster, name);
  if (!(raster.cell_m > 0.0) || !(raster.cell_y_m > 0.0) || !std::isfinite(raster.x_min_m) ||
      !std::isfinite(raster.y_min_m))
    return no_surface(name, "cells of positive size", fmt::format("{} × {} m", raster.cell_m, raster.cell_y_m));
  const int rows = raster.height_m.rows(), columns = raster.height_m.columns();
  if (rows < 2 || columns < 2)
    return no_surface(name, "a terrain of at least 2 × 2 heights", fmt::format("{} × {}", rows, columns));
  for (float& height : raster.height_m)
    if (!std::isfinite(height)) height = std::numeric_limits<float>::quiet_NaN();
  Terrain terrain;
  terrain.raster_ = std::move(raster);
  terrain.build_levels();
  const Bounds& all = terrain.levels_.back()(0, 0);
  if (all.low > all.high) return no_surface(name, "four neighbouring heights somewhere", "holes everywhere");
  return terrain;
}

void Terrain::build_levels() {
  int rows = raster_.height_m.rows() - 1, columns = raster_.height_m.columns() - 1;
  do {
    const int below_rows = rows, below_columns = columns;
    rows = (rows + 1) / 2;
    columns = (columns + 1) / 2;
    const Grid<Bounds>* below = levels_.empty() ? nullptr : &levels_.back();
    Grid<Bounds> level(rows, columns, Bounds{kInfinity, -kInfinity, true});
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        for (int child = 0; child < 4; ++child) {
          const int row = 2 * r + child / 2, column = 2 * c + child % 2;
          const bool inside = row < below_rows && column < below_columns;
          const Bounds part = !inside            ? Bounds{kInfinity, -kInfinity, false}
                              : below == nullptr ? patch_bounds(row, column)
                                                 : (*below)(row, column);
          Bounds& node = level(r, c);
          node = {std::min(node.low, part.low), std::max(node.high, part.high), node.complete && part.complete};
        }
    levels_.push_back(std::move(level));  // `below` is not used past this point
  } while (rows > 1 || columns > 1);
}

double Terrain::height_m(double x_m, double y_m) const {
  const auto& z = raster_.height_m;
  const double u = (x_m - x_min_m()) / raster_.cell_m, v = (y_m - y_min_m()) / raster_.cell_y_m;
  if (!(u >= 0.0 && v >= 0.0 && u <= z.columns() - 1 && v <= z.rows() - 1))
    return std::numeric_limits<double>::quiet_NaN();
  const int column = std::min(static_cast<int>(u), z.columns() - 2);
  const int row = std::min(static_cast<int>(v), z.rows() - 2);
  const double s = u - column, t = v - row;
  const double h00 = z(row, column), h01 = z(row, column + 1), h10 = z(row + 1, column), h11 = z(row + 1, column + 1);
  return h00 + (h01 - h00) * s + (h10 - h00) * t + (h00 - h01 - h10 + h11) * s * t;
}

std::string Terrain::extent() const {
  return fmt::format("x {:.6g} … {:.6g} m, y {:.6g} … {:.6g} m", x_min_m(), x_max_m(), y_min_m(), y_max_m());
}

}  // namespace scree::drivers
