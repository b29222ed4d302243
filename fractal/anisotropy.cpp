#include "fractal/anisotropy.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fractal/azimuth_null.hpp"
#include "fractal/contrast_test.hpp"
#include "fractal/grid_energies.hpp"

namespace scree::fractal {
namespace {

constexpr double kSignificance = 0.05;

Status check(const Grid<float>& height_m, double cell_m, const Grid<float>& variance_m2,
             const Grid<std::uint16_t>& hits) {
  const auto text = [](int n) { return std::to_string(n); };
  const auto shape = [&](int rows, int columns) { return text(rows) + " x " + text(columns); };
  const std::string expected = shape(height_m.rows(), height_m.columns());
  for (const auto& [name, found] : {std::pair{"variances", shape(variance_m2.rows(), variance_m2.columns())},
                                    std::pair{"hits", shape(hits.rows(), hits.columns())}})
    if (found != expected)
      return Error{ErrorKind::usage,
                   std::string("anisotropy: expected ") + name + " of shape " + expected + ", found " + found};
  if (!(cell_m > 0.0) || !std::isfinite(cell_m))
    return Error{ErrorKind::usage,
                 "anisotropy: expected a positive cell size in metres, found " + std::to_string(cell_m)};
  return {};
}

Status check(const DirectedEnergies& directed, const GridEnergies& energies) {
  const double fewest = *std::min_element(directed.count.begin(), directed.count.end());
  if (fewest < kMinDirectedCount || !energies.enough)
    return Error{ErrorKind::bad_data, "anisotropy: expected at least " +
                                          std::to_string(static_cast<int>(kMinDirectedCount)) +
                                          " complete second differences of every direction and step, found " +
                                          std::to_string(static_cast<int>(fewest))};
  if (energies.smooth) return Error{ErrorKind::bad_data, "anisotropy: expected rough ground, found heights on a plane"};
  return {};
}

/// Direction and stretch of an isotropic power law of exponent H whose energies have these contrasts: q(θ)^(1/H) is a
/// quadratic form of the direction. For a stretch along an axis, strength = exp(|u|/2H).
void describe(const Eigen::Vector2d& contrast, double hurst, Anisotropy& out) {
  const double along_axes = std::tanh(contrast(0) / (2.0 * hurst));
  const double along_diagonals = std::tanh(contrast(1) / (2.0 * hurst));
  double direction = 0.5 * std::atan2(along_diagonals, along_axes);
  if (direction < 0.0) direction += std::numbers::pi;
  out.direction_rad = direction;
  constexpr double kLargest = (kMaxStrength * kMaxStrength - 1.0) / (kMaxStrength * kMaxStrength + 1.0);
  const double eccentricity = std::min(std::hypot(along_axes, along_diagonals), kLargest);
  out.strength = std::sqrt((1.0 + eccentricity) / (1.0 - eccentricity));
}

}  // namespace

Result<Anisotropy> analyse_anisotropy(const Grid<float>& height_m, double cell_m, const Grid<float>& variance_m2,
                                      const Grid<std::uint16_t>& hits, Executor& executor) {
  if (const Status ok = check(height_m, cell_m, variance_m2, hits); !ok) return ok.error();
  MaskedHeights heights;
  load_heights(height_m, heights);
  const GridEnergies energies = grid_energies(heights, variance_m2, hits);
  const DirectedEnergies directed = directed_energies(heights);
  if (const Status ok = check(directed, energies); !ok) return ok.error();

  EnergyFit fit;
  fit_energies(dimension_tables(energies.support), {&energies.window, 1}, {&fit, 1});
  const double hurst = static_cast<double>(fit.hurst);
  IsotropicLaw law{energies.support, hurst, static_cast<double>(fit.c_value) * energies.unit_m2, energies.noise_m2};
  law.noise_m2 +=
      0.5 * law.c_m2 * static_cast<double>(energies.window.nugget) * mean_variogram(law.support, hurst, 0, 0);

  Anisotropy out;
  out.isotropic_hurst = hurst;
  const ContrastTest test = test_contrasts(directed, law, executor);
  out.chi_square = test.chi_square;
  out.p_value = std::exp(-0.5 * test.chi_square) * (1.0 + 0.5 * test.chi_square);
  out.significant = out.p_value < kSignificance;
  describe(test.signal_contrast, hurst, out);

  const int lag = azimuth_lag_cells(heights.rows, heights.columns, energies.known);
  const DirectionalHurst directional = directional_hurst(heights, law, lag, executor);
  out.hurst = directional.hurst;
  out.azimuth_lag_m = lag * cell_m;
  out.index_v = directional.index_v;
  out.index_v_null95 = index_v_null95(std::sqrt(energies.known), hurst);
  out.v_significant = out.index_v > out.index_v_null95;
  return out;
}

}  // namespace scree::fractal
