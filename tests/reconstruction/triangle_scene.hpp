#pragma once
// Samples of exact ground as scattered points, and realisations of it.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <vector>

#include "core/executor.hpp"
#include "core/random.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// A share of the cell centres of exact fBm, without noise.
struct ScatteredScene {
  Grid<float> truth;
  HeightSamples samples;
  SurfaceRequest request;

  ScatteredScene(double dimension, int side, double share, std::uint64_t seed)
      : truth(*fbm_surface({dimension, 0.2}, side, side, 0.1, seed)) {
    request.grid = {side, side, 0.1};
    request.law.law = {dimension, 0.2};
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c)
        if (to_uniform(random_words(seed, 5, c, r)[0]) < share) add(r, c);
  }
  void add(int r, int c) {
    samples.x_m.push_back((c + 0.5) * 0.1);
    samples.y_m.push_back((r + 0.5) * 0.1);
    samples.z_m.push_back(static_cast<double>(truth(r, c)));
    samples.variance_m2.push_back(0.0);
  }
  void add_corners() {
    const int last = truth.rows() - 1;
    for (const auto& [r, c] : {std::pair{0, 0}, {0, last}, {last, 0}, {last, last}})
      if (std::none_of(samples.z_m.begin(), samples.z_m.end(),
                       [z = static_cast<double>(truth(r, c))](double other) { return other == z; }))
        add(r, c);
  }
  /// Every fourth cell of the border: it lies within the hull and takes little from the rest.
  void add_border() {
    add_corners();
    for (int i = 4; i + 4 < truth.rows(); i += 4)
      for (const auto& [r, c] : {std::pair{0, i}, {truth.rows() - 1, i}, {i, 0}, {i, truth.rows() - 1}})
        if (std::none_of(samples.z_m.begin(), samples.z_m.end(),
                         [z = static_cast<double>(truth(r, c))](double other) { return other == z; }))
          add(r, c);
  }
  int row(std::size_t sample) const { return static_cast<int>(samples.y_m[sample] / 0.1); }
  int column(std::size_t sample) const { return static_cast<int>(samples.x_m[sample] / 0.1); }
};

template <class Method>
std::vector<Grid<float>> draws_of(SurfaceRequest request, const Method& method) {
  std::vector<Grid<float>> draws;
  request.draws = 3;
  request.on_draw = [&draws](int k, const Grid<float>& draw) {
    EXPECT_EQ(k, static_cast<int>(draws.size()));
    draws.push_back(draw);
  };
  const auto estimate = method(request);
  EXPECT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(draws.size(), 3u);
  return draws;
}

/// One index at a time, last first.
class Backwards final : public Executor {
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int i = count; i-- > 0;) body(i, i + 1);
  }
};

/// Bit by bit: NaN equals NaN.
inline bool same(const Grid<float>& a, const Grid<float>& b) {
  return a.rows() == b.rows() && a.columns() == b.columns() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace scree::fractal
