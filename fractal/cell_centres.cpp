#include "fractal/cell_centres.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::fractal {
namespace {

/// Sums over cells; heights relative to a common level.
struct Sums {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(const Sums& o, double sign) {
    n += sign * o.n, x += sign * o.x, y += sign * o.y, z += sign * o.z;
    xx += sign * o.xx, xy += sign * o.xy, yy += sign * o.yy, xz += sign * o.xz, yz += sign * o.yz;
  }
};

struct Slope {
  double x = 0.0, y = 0.0;
};

/// Of the least-squares plane, per cell.
Slope slope_of(const Sums& s) {
  constexpr double kFewest = 4.5, kFlat = 1e-3;
  if (s.n < kFewest) return {};
  const double xx = s.xx - s.x * s.x / s.n, xy = s.xy - s.x * s.y / s.n, yy = s.yy - s.y * s.y / s.n;
  const double xz = s.xz - s.x * s.z / s.n, yz = s.yz - s.y * s.z / s.n;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > kFlat * (xx + yy) * (xx + yy))) return {};
  return {(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant};
}

double known_mean(const Grid<float>& height_m) {
  double sum = 0.0, count = 0.0;
  for (const float z : height_m)
    if (std::isfinite(z)) sum += static_cast<double>(z), count += 1.0;
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

void move_to_centres(const Grid<float>& dx_cells, const Grid<float>& dy_cells, int radius_cells,
                     Grid<float>& height_m) {
  const int rows = height_m.rows(), columns = height_m.columns();
  const Grid<float> from = height_m;
  const double level = known_mean(from);
  const auto cell = [&](int r, int c) {
    Sums s;
    if (!std::isfinite(from(r, c))) return s;
    s.n = 1.0, s.x = c - 0.5 * columns + static_cast<double>(dx_cells(r, c));
    s.y = r - 0.5 * rows + static_cast<double>(dy_cells(r, c)), s.z = static_cast<double>(from(r, c)) - level;
    s.xx = s.x * s.x, s.xy = s.x * s.y, s.yy = s.y * s.y, s.xz = s.x * s.z, s.yz = s.y * s.z;
    return s;
  };
  std::vector<Sums> column(static_cast<std::size_t>(columns));  // of the window's rows
  const auto move_row = [&](int r, double sign) {
    if (r < 0 || r >= rows) return;
    for (int c = 0; c < columns; ++c) column[static_cast<std::size_t>(c)].add(cell(r, c), sign);
  };
  for (int r = 0; r < std::min(radius_cells, rows); ++r) move_row(r, 1.0);
  for (int r = 0; r < rows; ++r) {
    move_row(r + radius_cells, 1.0);
    move_row(r - radius_cells - 1, -1.0);
    Sums window;
    for (int c = 0; c < std::min(radius_cells, columns); ++c) window.add(column[static_cast<std::size_t>(c)], 1.0);
    for (int c = 0; c < columns; ++c) {
      if (c + radius_cells < columns) window.add(column[static_cast<std::size_t>(c + radius_cells)], 1.0);
      if (c > radius_cells) window.add(column[static_cast<std::size_t>(c - radius_cells - 1)], -1.0);
      if (!std::isfinite(from(r, c))) continue;
      const Slope slope = slope_of(window);
      const double rise = slope.x * static_cast<double>(dx_cells(r, c)) + slope.y * static_cast<double>(dy_cells(r, c));
      height_m(r, c) = static_cast<float>(static_cast<double>(from(r, c)) - rise);
    }
  }
}

}  // namespace scree::fractal
