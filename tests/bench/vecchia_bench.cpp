// The estimator of D for scattered points: time a point against a naive loop over all pairs, and (BENCHMARK
// "accuracy…") bias, RMSE, coverage on exact surfaces. docs/fractal.md quotes it.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "fractal/fbm_points.hpp"
#include "fractal/surface.hpp"
#include "fractal/vecchia.hpp"
#include "fractal/vecchia_neighbours.hpp"
#include "fractal/vecchia_points.hpp"

namespace {

using namespace scree::fractal;

struct Survey {
  std::vector<double> x, y, z;
  SurveyPoints points(double noise) const { return {.x_m = x, .y_m = y, .z_m = z, .noise_sigma_m = noise}; }
};

/// A chosen share of the cells of an exact surface: places at random on a fine lattice. Unit of length: the mean
/// spacing; of height: the rms change over it. Noise and tilt in these units.
Survey lattice_survey(double dimension, std::size_t count, int side, double noise, double tilt, std::uint64_t seed) {
  const double cell = std::sqrt(static_cast<double>(count)) / side;
  const auto surface = *fbm_surface({dimension, 1.0}, side, side, cell, seed);
  Survey survey;
  std::size_t wanted = count, left = surface.size();
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c, --left) {
      if (scree::to_uniform(scree::random_words(seed, 5, c, r)[0]) * static_cast<double>(left) >=
          static_cast<double>(wanted))
        continue;
      --wanted;
      survey.x.push_back(cell * c);
      survey.y.push_back(cell * r);
      survey.z.push_back(surface(r, c) + noise * scree::random_normals(seed, 6, c, r)[0] + tilt * cell * c);
    }
  return survey;
}

void per_point(benchmark::State& state, std::size_t count) {
  state.counters["us_per_point"] = benchmark::Counter(
      static_cast<double>(count) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void vecchia(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double noise = static_cast<double>(state.range(1)) / 100.0;
  const Survey survey = lattice_survey(2.4, count, 512, noise, 0.5, 1);
  for (auto _ : state) benchmark::DoNotOptimize(estimate_dimension_vecchia(survey.points(noise)));
  per_point(state, count);
}
BENCHMARK(vecchia)->ArgsProduct({{3277, 10000, 65536}, {0, 30}})->Unit(benchmark::kMillisecond);

void neighbours(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const auto prepared = *prepare_points(lattice_survey(2.4, count, 512, 0.0, 0.5, 1).points(0.0));
  for (auto _ : state) benchmark::DoNotOptimize(nearest_predecessors(prepared.points).data());
  per_point(state, count);
}
BENCHMARK(neighbours)->Arg(3277)->Arg(10000)->Arg(65536)->Unit(benchmark::kMillisecond);

/// What a structure function costs when written down as it is defined: every pair's distance, rounded to its lag.
void naive_all_pairs(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const Survey survey = lattice_survey(2.4, count, 512, 0.0, 0.5, 1);
  const auto lags = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)) / 4.0);
  std::vector<double> pairs(lags + 1), sum1(lags + 1), sum2(lags + 1);
  for (auto _ : state) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double dx = survey.x[i] - survey.x[j], dy = survey.y[i] - survey.y[j];
        const auto lag = static_cast<std::size_t>(std::lround(std::sqrt(dx * dx + dy * dy)));
        if (lag > lags) continue;
        const double dz = std::abs(survey.z[i] - survey.z[j]);
        pairs[lag] += 1.0;
        sum1[lag] += dz;
        sum2[lag] += dz * dz;
      }
    benchmark::DoNotOptimize(sum2.data());
  }
  per_point(state, count);
}
BENCHMARK(naive_all_pairs)->Arg(3277)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK(naive_all_pairs)->Arg(65536)->Iterations(1)->Unit(benchmark::kMillisecond);

struct Score {
  double sum = 0.0, sum2 = 0.0, covered = 0.0, sigma_covered = 0.0, log_amplitude = 0.0, edge = 0.0, scale = 0.0;
  int count = 0;

  void add(const DimensionEstimate& estimate, double dimension) {
    const double error = estimate.dimension - dimension;
    ++count;
    sum += error;
    sum2 += error * error;
    covered += estimate.interval95.low <= dimension && dimension <= estimate.interval95.high ? 1.0 : 0.0;
    sigma_covered += std::abs(error) < 1.96 * estimate.sigma ? 1.0 : 0.0;
    log_amplitude += std::log(estimate.amplitude_m);
    scale += estimate.flags & kScaleDependent ? 1.0 : 0.0;
    edge += estimate.flags & (kOpenBelow | kOpenAbove) ? 1.0 : 0.0;
  }
  void report(benchmark::State& state) const {
    state.counters["bias"] = sum / count;
    state.counters["rmse"] = std::sqrt(sum2 / count);
    state.counters["cover95"] = covered / count;
    state.counters["cover_sigma"] = sigma_covered / count;
    state.counters["log_amplitude"] = log_amplitude / count;
    state.counters["scale_dependent"] = scale / count;
    state.counters["open"] = edge / count;
  }
};

/// 5 % of the cells of 256 × 256, tilted; args: D·100, noise in % of the change over the mean spacing, surfaces.
void accuracy_3277(benchmark::State& state) {
  const double dimension = static_cast<double>(state.range(0)) / 100.0,
               noise = static_cast<double>(state.range(1)) / 100.0;
  Score score;
  for (auto _ : state)
    for (int i = 0; i < state.range(2); ++i) {
      const Survey survey = lattice_survey(dimension, 3277, 256, noise, 0.5, static_cast<std::uint64_t>(i));
      score.add(*estimate_dimension_vecchia(survey.points(noise)), dimension);
    }
  score.report(state);
}
BENCHMARK(accuracy_3277)
    ->ArgsProduct({{205, 220, 240, 260, 280, 290}, {0}, {400}})
    ->ArgsProduct({{205, 220, 240, 260, 280, 290}, {30}, {100}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

void noise_unknown(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double dimension = static_cast<double>(state.range(1)) / 100.0,
               noise = static_cast<double>(state.range(2)) / 100.0;
  Score score;
  double n1 = 0, n2 = 0;
  for (auto _ : state)
    for (int i = 0; i < state.range(3); ++i) {
      const Survey survey = lattice_survey(dimension, count, 256, noise, 0.5, static_cast<std::uint64_t>(i));
      SurveyPoints points = survey.points(0.0);
      points.noise_unknown = true;
      const auto e = *estimate_dimension_vecchia(points);
      score.add(e, dimension);
      n1 += e.noise_sigma_m;
      n2 += e.noise_sigma_m * e.noise_sigma_m;
    }
  score.report(state);
  const auto n = static_cast<double>(state.range(3));
  n1 /= n;
  state.counters["noise"] = n1;
  state.counters["noise_sd"] = std::sqrt(n2 / n - n1 * n1);
}
BENCHMARK(noise_unknown)
    ->ArgsProduct({{1000, 3277}, {205, 220, 240, 260, 290}, {0, 30}, {100}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

/// Places uniform in a square, new ones every 20 surfaces; args: N, D·100, noise in %, surfaces.
void accuracy_small(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double dimension = static_cast<double>(state.range(1)) / 100.0,
               noise = static_cast<double>(state.range(2)) / 100.0;
  Score score;
  for (auto _ : state)
    for (int set = 0; set < state.range(3) / 20; ++set) {
      Survey survey;
      for (std::size_t i = 0; i < count; ++i) {
        const auto words = scree::random_words(static_cast<std::uint64_t>(set), 10, static_cast<std::int32_t>(i), 0);
        survey.x.push_back(std::sqrt(static_cast<double>(count)) * scree::to_uniform(words[0]));
        survey.y.push_back(std::sqrt(static_cast<double>(count)) * scree::to_uniform(words[1]));
      }
      const auto truth = *FbmPoints::make({dimension, 1.0}, survey.x, survey.y);
      for (int draw = 0; draw < 20; ++draw) {
        const auto seed = static_cast<std::uint64_t>(20 * set + draw);
        survey.z = truth.draw(seed);
        for (std::size_t i = 0; i < count; ++i)
          survey.z[i] +=
              0.5 * survey.x[i] + noise * scree::random_normals(seed, 11, static_cast<std::int32_t>(i), 0)[0];
        score.add(*estimate_dimension_vecchia(survey.points(noise)), dimension);
      }
    }
  score.report(state);
}
BENCHMARK(accuracy_small)
    ->ArgsProduct({{50, 100, 200}, {205, 220, 240, 260, 280, 290}, {0, 30}, {1000}})
    ->ArgsProduct({{1000}, {220, 260, 290}, {0, 30}, {400}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
