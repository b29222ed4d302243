#pragma once
// Exact surfaces of two scales, with noise, or without long waves.

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.hpp"
#include "fractal/scale_laws.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

struct Raster {
  std::vector<double> x, y, z;
  SurveyPoints survey() const { return {.x_m = x, .y_m = y, .z_m = z}; }
};

/// Of unit rms change over a cell (H); a second fBm (coarse_hurst) as large at `crossover` cells; unit white noise; or
/// high-passed: less its mean under a Gaussian of 8 cells.
struct Composite {
  ScaleLaw truth = ScaleLaw::power;
  double hurst = 0.5, coarse_hurst = 0.8, crossover = 10.0;
};

inline std::vector<double> gaussian_mean(const Grid<float>& in, int first, int size, double sigma) {
  const int reach = static_cast<int>(4.0 * sigma), wide = size + 2 * reach;
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma))), sum += weights.back();
  std::vector<double> rows(static_cast<std::size_t>(wide) * static_cast<std::size_t>(size)), out;
  for (int r = 0; r < wide; ++r)
    for (int c = 0; c < size; ++c) {
      double value = 0.0;
      for (int i = -reach; i <= reach; ++i)
        value += weights[static_cast<std::size_t>(i + reach)] / sum * in(first - reach + r, first + c + i);
      rows[static_cast<std::size_t>(r * size + c)] = value;
    }
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < size; ++c) {
      double value = 0.0;
      for (int i = 0; i <= 2 * reach; ++i)
        value += weights[static_cast<std::size_t>(i)] / sum * rows[static_cast<std::size_t>((r + i) * size + c)];
      out.push_back(value);
    }
  return out;
}

/// size × size cells of 1 m.
inline Raster composite_raster(const Composite& composite, int size, std::uint64_t seed) {
  constexpr double kFilter = 8.0;
  const int margin = composite.truth == ScaleLaw::plateau ? static_cast<int>(4.0 * kFilter) : 0;
  const auto ground = *fbm_surface({3.0 - composite.hurst, 1.0}, size + 2 * margin, size + 2 * margin, 1.0, seed);
  Raster out;
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < size; ++c) {
      out.x.push_back(c);
      out.y.push_back(r);
      out.z.push_back(ground(r + margin, c + margin));
      if (composite.truth == ScaleLaw::power_and_noise) out.z.back() += random_normals(seed, 9, c, r)[0];
    }
  if (composite.truth == ScaleLaw::two_scales) {
    const double amplitude = std::pow(composite.crossover, composite.hurst - composite.coarse_hurst);
    const auto coarse = *fbm_surface({3.0 - composite.coarse_hurst, amplitude}, size, size, 1.0, seed + 1000000);
    for (std::size_t i = 0; i < out.z.size(); ++i) out.z[i] += coarse[i];
  }
  if (composite.truth == ScaleLaw::plateau) {
    const auto mean = gaussian_mean(ground, margin, size, kFilter);
    for (std::size_t i = 0; i < out.z.size(); ++i) out.z[i] -= mean[i];
  }
  return out;
}

}  // namespace scree::fractal
