#pragma once
// Exact ground with a cliff across it and rocks on it.

#include <cmath>

#include "fractal/reconstruction/distance_transform.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::fractal {

inline constexpr double kCliff = 25.0;  ///< in units of the change over one cell
inline constexpr int kRocks = 5;

/// The measured heights rise with the ground. Rocks: discs of radius 5 … 13 cells, 10 … 20 units high.
struct BrokenScene : SparseScene {
  Grid<std::int32_t> edge2;  ///< squared distance to the nearest cell beside an edge

  BrokenScene(double dimension, int rows, int columns, double density, std::uint64_t seed, double noise = 0.1)
      : SparseScene(dimension, rows, columns, density, seed, noise) {
    const double unit = law.rms_change_m(kSceneCellM);
    Grid<float> rise(rows, columns, 0.0F);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const double cliff = 0.5 * columns + 0.12 * columns * std::sin(6.0 * r / rows + static_cast<double>(seed));
        if (c > cliff) rise(r, c) += static_cast<float>(kCliff * unit);
        for (int k = 0; k < kRocks; ++k) {
          const auto place = random_words(seed, 60, k, 0), form = random_words(seed, 61, k, 0);
          const double radius = 5.0 + 8.0 * to_uniform(form[0]), tall = 10.0 + 10.0 * to_uniform(form[1]);
          if (std::hypot(r - rows * to_uniform(place[0]), c - columns * to_uniform(place[1])) < radius)
            rise(r, c) += static_cast<float>(tall * unit);
        }
      }
    Grid<std::uint8_t> beside(rows, columns, 0);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        if (c + 1 < columns && rise(r, c) != rise(r, c + 1)) beside(r, c) = beside(r, c + 1) = 1;
        if (r + 1 < rows && rise(r, c) != rise(r + 1, c)) beside(r, c) = beside(r + 1, c) = 1;
        truth(r, c) += rise(r, c);
        height(r, c) += rise(r, c);
      }
    SerialExecutor serial;
    DistanceTransform().transform(beside, serial, edge2);
  }
  bool near(int r, int c) const { return edge2(r, c) <= 16; }
};

}  // namespace scree::fractal
