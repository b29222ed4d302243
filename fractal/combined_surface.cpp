#include "fractal/combined_surface.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "fractal/profile_pair.hpp"

namespace scree::fractal {
namespace {

Status check(const CombinedLaw& law, int rows, int columns, double cell_m) {
  const auto usage = [](std::string message) { return Error{ErrorKind::usage, std::move(message)}; };
  if (rows < 2 || columns < 2)
    return usage(fmt::format("combined surface: expected at least 2 x 2 cells, found {} x {}", rows, columns));
  constexpr double kMostCells = 16384.0 * 16384.0;  // 1 GB
  if (static_cast<double>(rows) * columns > kMostCells)
    return usage(fmt::format("combined surface: expected at most 16384 x 16384 cells, found {} x {}", rows, columns));
  if (!(law.weight >= 0.0 && law.weight <= 1.0))
    return usage(fmt::format("combined surface: expected 0 <= weight <= 1, found {}", law.weight));
  if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
    return usage(fmt::format("combined surface: expected a finite amplitude_m > 0, found {}", law.amplitude_m));
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return usage(fmt::format("combined surface: expected a finite cell_m > 0, found {}", cell_m));
  return {};
}

struct Terms {  // of the squared change
  double a, b, c;
};

Terms terms(const CombinedLaw& law, double azimuth_rad, double lag_m) {
  const double x = std::abs(lag_m * std::cos(azimuth_rad)), y = std::abs(lag_m * std::sin(azimuth_rad));
  const double p = law.weight, q = 1.0 - p, h = law.hurst_x + law.hurst_y, square = law.amplitude_m * law.amplitude_m;
  return {p * p * square * std::pow(x, 2.0 * law.hurst_x), q * q * square * std::pow(y, 2.0 * law.hurst_y),
          p * q * law.correlation * square * (std::pow(x, h) + std::pow(y, h) - std::pow(std::abs(x - y), h))};
}

}  // namespace

Result<Grid<float>> combined_surface(const CombinedLaw& law, int rows, int columns, double cell_m, std::uint64_t seed) {
  if (Status status = check(law, rows, columns, cell_m); !status) return status.error();
  const auto pair = fbm_profile_pair(law.hurst_x, law.hurst_y, law.correlation, std::max(rows, columns), seed);
  if (!pair) return pair.error();
  const double along_x = law.weight * law.amplitude_m * std::pow(cell_m, law.hurst_x);
  const double along_y = (1.0 - law.weight) * law.amplitude_m * std::pow(cell_m, law.hurst_y);
  Grid<float> surface(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      surface(r, c) = static_cast<float>(along_x * pair->first[static_cast<std::size_t>(c)] +
                                         along_y * pair->second[static_cast<std::size_t>(r)]);
  return surface;
}

double combined_squared_change(const CombinedLaw& law, double azimuth_rad, double lag_m) {
  const auto [a, b, c] = terms(law, azimuth_rad, lag_m);
  return a + b + c;
}

double combined_hurst(const CombinedLaw& law, double azimuth_rad, double lag_m) {
  const auto [a, b, c] = terms(law, azimuth_rad, lag_m);
  return law.hurst_x + (b + 0.5 * c) * (law.hurst_y - law.hurst_x) / (a + b + c);
}

}  // namespace scree::fractal
