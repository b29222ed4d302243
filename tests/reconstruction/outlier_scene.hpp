#pragma once
// Exact ground with wrong data on it, and how far a mean is from the truth.

#include <cmath>

#include "fractal/reconstruction/cell_samples.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::fractal {

inline CellSamples cells_of(const SparseScene& scene) {
  CellSamples samples{scene.height, scene.variance,
                      Grid<std::uint16_t>(scene.height.rows(), scene.height.columns(), 0)};
  for (std::size_t i = 0; i < scene.height.size(); ++i)
    if (!std::isnan(scene.height[i])) {
      samples.hits[i] = 1;
      ++samples.cells;
    }
  samples.inside = samples.cells;
  return samples;
}

/// 3 % of the data are off by 8 … 25 times the change over one cell, up or down.
struct OutlierScene : SparseScene {
  CellSamples samples, told;  ///< with the outliers; without, as one who knows them would have it
  Grid<std::uint8_t> wrong;

  OutlierScene(double dimension, int rows, int columns, double density, std::uint64_t seed)
      : SparseScene(dimension, rows, columns, density, seed),
        samples(cells_of(*this)),
        told(samples),
        wrong(rows, columns, 0) {
    const double unit = law.rms_change_m(kSceneCellM);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const auto words = random_words(seed, 40, c, r);
        if (std::isnan(height(r, c)) || to_uniform(words[0]) >= 0.03) continue;
        wrong(r, c) = 1;
        samples.height_m(r, c) += static_cast<float>((words[2] & 1U ? unit : -unit) * (8 + 17 * to_uniform(words[1])));
        told.height_m(r, c) = told.variance_m2(r, c) = NAN;
        --told.cells;
      }
  }
};

/// In units of the change over one cell, over the cells that the scene did not measure.
inline double rmse_of_mean(const SparseScene& scene, const CellSamples& samples) {
  ConditionalReconstructor reconstructor({.cell_m = kSceneCellM, .max_cells = scene.height.rows()});
  SerialExecutor serial;
  Reconstruction out;
  reconstructor.reconstruct(samples.height_m, samples.variance_m2, scene.window(), scene.law, serial, out);
  double sum2 = 0.0, n = 0.0;
  for (std::size_t i = 0; i < scene.height.size(); ++i) {
    if (!std::isnan(scene.height[i])) continue;
    sum2 += std::pow(static_cast<double>(out.mean_m[i] - scene.truth[i]), 2);
    n += 1.0;
  }
  return std::sqrt(sum2 / n) / scene.law.rms_change_m(kSceneCellM);
}

}  // namespace scree::fractal
