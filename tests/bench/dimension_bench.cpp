// D for every cell: time of a map, of the tables, and (BENCHMARK "accuracy") bias, RMSE, coverage and false alarms on
// exact surfaces. docs/fractal.md quotes it.

#include <benchmark/benchmark.h>
#include <cmath>

#include "core/random.hpp"
#include "fractal/dimension_map.hpp"
#include "fractal/dimension_tables.hpp"
#include "fractal/surface.hpp"

namespace {

using scree::Grid;
using namespace scree::fractal;

struct Scene {
  Grid<float> height, variance;
  Grid<std::uint16_t> hits;
};

/// A surface with `empty` of its cells unknown and white noise of `noise` of the rms change over one cell.
Scene make_scene(double dimension, int side, double cell_m, double empty, double noise, std::uint64_t seed) {
  const FractalLaw law{dimension, 0.1};
  Scene scene{*fbm_surface(law, side, side, cell_m, seed), {}, Grid<std::uint16_t>(side, side, 0)};
  const double sigma = noise * law.rms_change_m(cell_m);
  scene.variance.assign(side, side, static_cast<float>(sigma * sigma));
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      scene.height(r, c) += static_cast<float>(sigma * scree::random_normals(seed, 77, c, r)[0]);
      if (scree::to_uniform(scree::random_words(seed, 78, c, r)[0]) < empty) scene.height(r, c) = NAN;
    }
  return scene;
}

void map_time(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const Scene scene = make_scene(2.4, side, 0.1, 0.2, state.range(1) ? 0.3 : 0.0, 1);
  DimensionMapper mapper({});
  scree::SerialExecutor serial;
  DimensionMap map;
  for (auto _ : state) mapper.update(scene.height, scene.variance, scene.hits, serial, map);
}
BENCHMARK(map_time)->Args({200, 0})->Args({200, 1})->Args({400, 1})->Unit(benchmark::kMillisecond);

/// The same map updated in place after a block of heights in its middle has changed; args: side, changed cells in 1000.
void update_time(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  Scene scene = make_scene(2.4, side, 0.1, 0.2, 0.3, 1);
  DimensionMapper mapper({});
  scree::SerialExecutor serial;
  const scree::LatticeWindow window{{0, 0}, side, side};
  mapper.update(window, scene.height, scene.variance, scene.hits, serial);
  const int block = static_cast<int>(std::lround(side * std::sqrt(static_cast<double>(state.range(1)) / 1000.0)));
  const int first = (side - block) / 2;
  for (auto _ : state) {
    for (int r = first; r < first + block; ++r)
      for (int c = first; c < first + block; ++c) scene.height(r, c) += 0.001F;
    mapper.update(window, scene.height, scene.variance, scene.hits, serial);
  }
}
BENCHMARK(update_time)->ArgsProduct({{200, 400}, {0, 1, 10, 30, 100, 300, 1000}})->Unit(benchmark::kMillisecond);

/// The window moved by two cells along x in every update, nothing else new.
void scroll_time(benchmark::State& state) {
  const int side = 200, length = 1000;
  const Scene scene = make_scene(2.4, length, 0.1, 0.2, 0.3, 1);
  Scene seen = make_scene(2.4, side, 0.1, 0.2, 0.3, 1);
  DimensionMapper mapper({});
  scree::SerialExecutor serial;
  int x = 0;
  for (auto _ : state) {
    state.PauseTiming();
    x = x + 2 + side <= length ? x + 2 : 0;
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) seen.height(r, c) = scene.height(r, x + c);
    if (x == 0) mapper.update({{x, 0}, side, side}, seen.height, seen.variance, seen.hits, serial);
    state.ResumeTiming();
    if (x != 0) mapper.update({{x, 0}, side, side}, seen.height, seen.variance, seen.hits, serial);
  }
}
BENCHMARK(scroll_time)->Unit(benchmark::kMillisecond);

/// Central cell of each 30-cell surface (a 21 × 21 window with its full reach); args: D·100, noise %, empty %.
void accuracy(benchmark::State& state) {
  const double dimension = static_cast<double>(state.range(0)) / 100.0;
  const int surfaces = 400, side = 29;
  scree::SerialExecutor serial;
  double sum = 0.0, sum2 = 0.0, covered = 0.0, rejected = 0.0, anisotropic = 0.0, amplitude = 0.0;
  for (auto _ : state) {
    DimensionMapper mapper({});
    DimensionMap map;
    for (int i = 0; i < surfaces; ++i) {
      const Scene scene = make_scene(dimension, side, 0.1, static_cast<double>(state.range(2)) / 100.0,
                                     static_cast<double>(state.range(1)) / 100.0, static_cast<std::uint64_t>(i));
      mapper.update(scene.height, scene.variance, scene.hits, serial, map);
      const double error = map.dimension(14, 14) - dimension;
      sum += error;
      sum2 += error * error;
      covered += std::abs(error) < 1.96 * map.dimension_sigma(14, 14) ? 1.0 : 0.0;
      rejected += map.flags(14, 14) & kNotFractal ? 1.0 : 0.0;
      anisotropic += map.flags(14, 14) & kAnisotropic ? 1.0 : 0.0;
      amplitude += std::log(map.amplitude_m(14, 14) / 0.1);
    }
  }
  state.counters["bias"] = sum / surfaces;
  state.counters["rmse"] = std::sqrt(sum2 / surfaces);
  state.counters["cover95"] = covered / surfaces;
  state.counters["not_fractal"] = rejected / surfaces;
  state.counters["anisotropic"] = anisotropic / surfaces;
  state.counters["log_amplitude_bias"] = amplitude / surfaces;
}
BENCHMARK(accuracy)
    ->ArgsProduct({{210, 230, 250, 270, 290}, {0, 30}, {0, 30}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
