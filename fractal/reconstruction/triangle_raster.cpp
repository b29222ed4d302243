#include "fractal/reconstruction/triangle_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr double kEdge = 1e-9;  // cells

struct Span {
  double low = 1e300, high = -1e300;
  void include(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// What the line y = `row` cuts out of the edge from a to b.
void cut(const SurfacePoint& a, const SurfacePoint& b, double row, Span& span) {
  const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
  if (row < low - kEdge || row > high + kEdge) return;
  if (high - low <= 2.0 * kEdge) {
    span.include(a.x);
    span.include(b.x);
  } else {
    span.include(a.x + (b.x - a.x) * std::clamp((row - a.y) / (b.y - a.y), 0.0, 1.0));
  }
}

int first_cell(double from) {
  return static_cast<int>(std::ceil(std::max(from - kEdge, 0.0)));
}
int last_cell(double to, int count) {
  return static_cast<int>(std::floor(std::min(to + kEdge, count - 1.0)));
}

}  // namespace

void rasterise_triangle(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, Grid<float>& out) {
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0.0) return;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  if (right < -kEdge || first_cell(left) > last_cell(right, out.columns())) return;  // most small triangles
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  if (high < -kEdge) return;
  const int last_row = last_cell(high, out.rows());
  for (int row = first_cell(low); row <= last_row; ++row) {
    Span span;
    cut(a, b, row, span);
    cut(b, c, row, span);
    cut(c, a, row, span);
    if (span.high < -kEdge) continue;
    const int last_column = last_cell(span.high, out.columns());
    for (int column = first_cell(span.low); column <= last_column; ++column) {
      const double x = column - a.x, y = row - a.y;
      const double to_b = std::clamp((x * (c.y - a.y) - y * (c.x - a.x)) / area, 0.0, 1.0);
      const double to_c = std::clamp(((b.x - a.x) * y - (b.y - a.y) * x) / area, 0.0, 1.0 - to_b);
      out(row, column) = static_cast<float>(a.z_m + to_b * (b.z_m - a.z_m) + to_c * (c.z_m - a.z_m));
    }
  }
}

}  // namespace scree::fractal
