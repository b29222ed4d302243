// Anisotropy on exact surfaces: false alarms and power of the contrast test, and the null quantiles of the index V that
// fractal/azimuth_null.cpp tabulates. docs/fractal.md quotes it.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "fractal/anisotropy.hpp"
#include "fractal/azimuth_null.hpp"
#include "fractal/surface.hpp"

namespace {

using scree::Grid;
using namespace scree::fractal;

struct Scene {
  double hurst = 0.5;
  int side = 21;
  int stretch = 1;     ///< along x: of a longer surface, every stretch-th row is taken
  double noise = 0.0;  ///< of the rms change over one cell
  double empty = 0.0;
  bool ridges = false;  ///< sum of a profile along x with H = hurst and one along y with H = 2·hurst, as in [X09]
};

Grid<float> surface(const Scene& scene, std::uint64_t seed) {
  const FractalLaw law{3.0 - scene.hurst, 0.1};
  if (!scene.ridges) return *fbm_surface(law, scene.side * scene.stretch, scene.side, 0.1, seed);
  const FractalLaw smooth{3.0 - 2.0 * scene.hurst,
                          0.1 * law.rms_change_m(0.1) / FractalLaw{3.0 - 2.0 * scene.hurst, 0.1}.rms_change_m(0.1)};
  const Grid<float> along_x = *fbm_surface(law, 1, scene.side, 0.1, 2 * seed);
  const Grid<float> along_y = *fbm_surface(smooth, scene.side, 1, 0.1, 2 * seed + 1);
  Grid<float> sum(scene.side, scene.side);
  for (int r = 0; r < scene.side; ++r)
    for (int c = 0; c < scene.side; ++c) sum(r, c) = along_x(0, c) + along_y(r, 0);
  return sum;
}

Anisotropy analyse(const Scene& scene, std::uint64_t seed) {
  const FractalLaw law{3.0 - scene.hurst, 0.1};
  const Grid<float> dense = surface(scene, seed);
  Grid<float> height(scene.side, scene.side);
  const double sigma = scene.noise * law.rms_change_m(0.1);
  for (int r = 0; r < scene.side; ++r)
    for (int c = 0; c < scene.side; ++c) {
      height(r, c) = dense(r * scene.stretch, c) + static_cast<float>(sigma * scree::random_normals(seed, 77, c, r)[0]);
      if (scree::to_uniform(scree::random_words(seed, 78, c, r)[0]) < scene.empty) height(r, c) = NAN;
    }
  scree::SerialExecutor serial;
  return *analyse_anisotropy(height, 0.1, Grid<float>(scene.side, scene.side, static_cast<float>(sigma * sigma)),
                             Grid<std::uint16_t>(scene.side, scene.side, 0), serial);
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void run(benchmark::State& state, const Scene& scene, int surfaces) {
  std::vector<double> v, strength;
  double significant = 0.0, v_significant = 0.0, extreme = 0.0;
  for (auto _ : state)
    for (int i = 0; i < surfaces; ++i) {
      const Anisotropy a = analyse(scene, static_cast<std::uint64_t>(i));
      significant += a.significant;
      extreme += a.p_value < 0.001;
      v_significant += a.v_significant;
      v.push_back(a.index_v);
      strength.push_back(a.strength);
    }
  state.counters["chi2_5%"] = significant / surfaces;
  state.counters["chi2_.1%"] = extreme / surfaces;
  state.counters["V_5%"] = v_significant / surfaces;
  state.counters["V50"] = quantile(v, 0.5);
  state.counters["V95"] = quantile(v, 0.95);
  state.counters["strength50"] = quantile(strength, 0.5);
}

/// args: side, 100·H, stretch, noise %, empty %.
void test(benchmark::State& state) {
  run(state,
      {static_cast<double>(state.range(1)) / 100.0, static_cast<int>(state.range(0)), static_cast<int>(state.range(2)),
       static_cast<double>(state.range(3)) / 100.0, static_cast<double>(state.range(4)) / 100.0},
      state.range(0) > 100 ? 200 : 1000);
}
BENCHMARK(test)
    ->ArgsProduct({{21, 41, 64}, {10, 35, 50, 70, 90}, {1}, {0}, {0}})
    ->ArgsProduct({{21, 41}, {35, 70}, {1}, {0, 30}, {0, 30}})
    ->ArgsProduct({{21}, {10, 20, 35, 50, 70, 90}, {2}, {0, 30}, {0}})
    ->ArgsProduct({{41, 64}, {35, 70}, {2}, {0}, {0}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

/// As above for the sum of two profiles. args: side, 100·H.
void test_ridges(benchmark::State& state) {
  run(state,
      {.hurst = static_cast<double>(state.range(1)) / 100.0, .side = static_cast<int>(state.range(0)), .ridges = true},
      200);
}
BENCHMARK(test_ridges)->ArgsProduct({{21, 41, 64, 128}, {30, 40}})->Iterations(1)->Unit(benchmark::kMillisecond);

/// The table of fractal/azimuth_null.cpp: run with --benchmark_filter=null and copy the counter V95. args: side, 100·H.
void null(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  run(state, {.hurst = static_cast<double>(state.range(1)) / 100.0, .side = side}, side > 100 ? 300 : 1000);
}
BENCHMARK(null)
    ->ArgsProduct({{16, 20, 28, 40, 64, 100, 160, 256}, {10, 30, 50, 70, 90}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
