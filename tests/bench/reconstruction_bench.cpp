// Reconstruction: cold and warm time, and (BENCHMARK "quality") coverage, roughness and errors on exact surfaces.
// the tables of docs/reconstruction.md are those of reconstruction_accuracy.

#include <benchmark/benchmark.h>
#include <cmath>

#include "core/random.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace {

using namespace scree;
using namespace scree::fractal;

/// args: side, D·100, density %
void cold(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const FractalLaw law{static_cast<double>(state.range(1)) / 100.0, kSceneAmplitudeM};
  const SparseScene scene(law.dimension, side, side, static_cast<double>(state.range(2)) / 100.0, 1);
  ConditionalReconstructor reconstructor({.cell_m = kSceneCellM, .max_cells = side});
  SerialExecutor serial;
  Reconstruction out;
  reconstructor.reconstruct(scene.height, scene.variance, {{0, 0}, side, side}, law, serial, out);  // makes the tiles
  int place = 1;
  for (auto _ : state)  // far away each time: no warm start
    reconstructor.reconstruct(scene.height, scene.variance, {{100000 * place++, 0}, side, side}, law, serial, out);
  state.counters["cycles"] = out.iterations;
  state.counters["converged"] = out.converged;
}
BENCHMARK(cold)->ArgsProduct({{200, 256, 400}, {220, 250, 280}, {5, 30}})->Unit(benchmark::kMillisecond);

/// The window rolls by 2 cells a frame over fixed ground; a tenth of the measured cells is measured afresh.
void warm(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0)), travel = 64;
  const FractalLaw law{static_cast<double>(state.range(1)) / 100.0, kSceneAmplitudeM};
  const SparseScene world(law.dimension, side + travel, side + travel, 0.3, 1);
  ConditionalReconstructor reconstructor({.cell_m = kSceneCellM, .max_cells = side});
  SerialExecutor serial;
  Reconstruction out;
  Grid<float> height(side, side), variance(side, side);
  int offset = 0, frame = 0;
  double cycles = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    offset = (offset + 2) % travel;
    ++frame;
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        const auto words = random_words(7, static_cast<std::uint64_t>(frame), c, r);
        const float sigma = std::sqrt(world.variance(r, c + offset));
        const bool fresh = to_uniform(words[0]) < 0.1;
        height(r, c) = world.height(r, c + offset) + (fresh ? 0.5F * sigma : 0.0F);
        variance(r, c) = world.variance(r, c + offset);
      }
    if (offset == 0) reconstructor.reconstruct(height, variance, {{-2, 0}, side, side}, law, serial, out);
    state.ResumeTiming();
    reconstructor.reconstruct(height, variance, {{offset, 0}, side, side}, law, serial, out);
    cycles += out.iterations;
  }
  state.counters["cycles"] = benchmark::Counter(cycles, benchmark::Counter::kAvgIterations);
}
BENCHMARK(warm)->ArgsProduct({{200}, {220, 250, 280}})->Unit(benchmark::kMillisecond);

/// args: D·100. Three surfaces of 256 × 256 cells, 5 % measured, 16 draws each (seeds).
void quality(benchmark::State& state) {
  const FractalLaw law{static_cast<double>(state.range(0)) / 100.0, kSceneAmplitudeM};
  constexpr int kSide = 256, kDraws = 16, kSurfaces = 3;
  const double unit = law.rms_change_m(kSceneCellM);
  double mean2 = 0, draw2 = 0, roughness = 0, covered = 0, cells = 0;
  SerialExecutor serial;
  for (auto _ : state)
    for (std::uint64_t surface = 0; surface < kSurfaces; ++surface) {
      const SparseScene scene(law.dimension, kSide, kSide, 0.05, surface);
      const double target = axis_dimension(scene.truth);
      Grid<float> sum2(kSide, kSide, 0.0F), mean;
      for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
        ConditionalReconstructor reconstructor({.cell_m = kSceneCellM, .max_cells = kSide, .seed = seed});
        Reconstruction out;
        reconstructor.reconstruct(scene.height, scene.variance, {{0, 0}, kSide, kSide}, law, serial, out);
        mean = out.mean_m;
        roughness += (axis_dimension(out.draw_m) - target) / (kDraws * kSurfaces);
        for (std::size_t i = 0; i < mean.size(); ++i) {
          sum2[i] += std::pow(out.draw_m[i] - mean[i], 2.0F);
          if (std::isnan(scene.height[i])) draw2 += std::pow((out.draw_m[i] - scene.truth[i]) / unit, 2) / kDraws;
        }
      }
      for (std::size_t i = 0; i < mean.size(); ++i) {
        if (!std::isnan(scene.height[i])) continue;
        const double error = std::abs(static_cast<double>(mean[i] - scene.truth[i]));
        mean2 += error * error / (unit * unit);
        covered += error < 1.7459 * std::sqrt(static_cast<double>(sum2[i]) / kDraws) ? 1 : 0;  // t, 16 d.o.f., 95 %
        cells += 1;
      }
    }
  state.counters["rmse_mean"] = std::sqrt(mean2 / cells);
  state.counters["rmse_draw"] = std::sqrt(draw2 / cells);
  state.counters["cov90"] = covered / cells;
  state.counters["dD"] = roughness;
}
BENCHMARK(quality)->Arg(220)->Arg(230)->Arg(250)->Arg(270)->Arg(280)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
