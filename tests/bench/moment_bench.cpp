// Yokoya's and Pentland's D and its interval on exact surfaces, clean and level: bias, RMSE, mean standard deviation
// that the interval is made of, coverage. docs/dimension.md quotes it.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "fractal/moment_dimension.hpp"
#include "fractal/surface.hpp"

namespace {

using namespace scree::fractal;

constexpr int kSurfaces = 200;

/// A share of the cells of an exact surface of side².
struct Survey {
  std::vector<double> x, y, z;

  Survey(double dimension, int side, double share, std::uint64_t seed) {
    const auto surface = *fbm_surface({dimension, 1.0}, side, side, 1.0, seed);
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        if (scree::to_uniform(scree::random_words(seed, 9, c, r)[0]) >= share) continue;
        x.push_back(c), y.push_back(r), z.push_back(static_cast<double>(surface(r, c)));
      }
  }
};

/// Range: D in hundredths, side, share of the cells in percent, moment.
void accuracy(benchmark::State& state) {
  const double truth = static_cast<double>(state.range(0)) / 100.0;
  MomentOptions options;
  options.moment = static_cast<Moment>(state.range(3));
  scree::SerialExecutor executor;
  double bias = 0.0, square = 0.0, sigma = 0.0, covered = 0.0, judged = 0.0;
  for (auto _ : state) {
    bias = square = sigma = covered = judged = 0.0;
    for (std::uint64_t seed = 1; seed <= kSurfaces; ++seed) {
      const Survey survey(truth, static_cast<int>(state.range(1)), static_cast<double>(state.range(2)) / 100.0, seed);
      const auto found =
          estimate_dimension_moment({.x_m = survey.x, .y_m = survey.y, .z_m = survey.z}, options, executor);
      if (!found) return state.SkipWithError(found.error().message.c_str());
      const double error = found->fit.dimension - truth;
      bias += error / kSurfaces, square += error * error / kSurfaces;
      if (std::isfinite(found->estimate.sigma)) sigma += found->estimate.sigma, ++judged;
      covered += found->estimate.interval95.low < truth && truth < found->estimate.interval95.high;
    }
  }
  state.counters["bias"] = bias;
  state.counters["rmse"] = std::sqrt(square);
  state.counters["sigma"] = sigma / std::max(judged, 1.0);
  state.counters["covers"] = covered / kSurfaces;
}
BENCHMARK(accuracy)
    ->ArgsProduct({{210, 220, 240, 260, 280, 290}, {64}, {100}, {0, 1}})
    ->ArgsProduct({{210, 220, 240, 260, 280, 290}, {128}, {20}, {0, 1}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
