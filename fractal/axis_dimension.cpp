#include "fractal/axis_dimension.hpp"

#include <cmath>
#include <cstddef>

namespace scree::fractal {
namespace {

/// Sum and number of the finite |b − a| of two stretches.
struct Changes {
  double sum = 0.0;
  std::size_t count = 0;

  void add(const float* a, const float* b, int n) {
    for (int i = 0; i < n; ++i) {
      const auto change = static_cast<double>(std::abs(b[i] - a[i]));
      if (!std::isfinite(change)) continue;
      sum += change;
      ++count;
    }
  }
};

}  // namespace

double axis_dimension(const Grid<float>& height_m, int lags) {
  const int rows = height_m.rows(), columns = height_m.columns();
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (int lag = 1; lag <= lags; ++lag) {
    Changes changes;
    for (int r = 0; r < rows; ++r) {
      const float* row = height_m.row(r).data();
      if (lag < columns) changes.add(row, row + lag, columns - lag);
      if (r + lag < rows) changes.add(row, height_m.row(r + lag).data(), columns);
    }
    const double x = std::log(lag), y = std::log(changes.sum / static_cast<double>(changes.count));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double dimension = 3.0 - (sxy - sx * sy / lags) / (sxx - sx * sx / lags);
  return std::isfinite(dimension) ? dimension : std::nan("");
}

}  // namespace scree::fractal
