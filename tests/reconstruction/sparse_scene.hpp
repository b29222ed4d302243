#pragma once
// Exact ground of which a part is measured, with noise.

#include <cmath>
#include <cstdint>

#include "core/grid.hpp"
#include "core/random.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::fractal {

inline constexpr double kSceneCellM = 0.1, kSceneAmplitudeM = 0.2;

/// `density` of the cells are known; `noise` is the sd of their heights over the change of one cell.
struct SparseScene {
  FractalLaw law;
  double sigma;  // of the measurement noise
  Grid<float> truth, height, variance;

  SparseScene(double dimension, int rows, int columns, double density, std::uint64_t seed, double noise = 0.0316)
      : law{dimension, kSceneAmplitudeM},
        sigma(noise * law.rms_change_m(kSceneCellM)),
        truth(*fbm_surface(law, rows, columns, kSceneCellM, seed)),
        height(rows, columns, NAN),
        variance(rows, columns, NAN) {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        if (to_uniform(random_words(seed, 5, c, r)[0]) < density) {
          height(r, c) = truth(r, c) + static_cast<float>(sigma * random_normals(seed, 6, c, r)[0]);
          variance(r, c) = static_cast<float>(sigma * sigma);
        }
  }
  CellSamples cells() const {
    CellSamples samples{height, variance, Grid<std::uint16_t>(height.rows(), height.columns(), 0)};
    for (std::size_t i = 0; i < height.size(); ++i)
      if (!std::isnan(height[i])) samples.hits[i] = 1, ++samples.cells, ++samples.inside;
    return samples;
  }
  LatticeWindow window(CellIndex min = {0, 0}) const { return {min, height.rows(), height.columns()}; }
};

}  // namespace scree::fractal
