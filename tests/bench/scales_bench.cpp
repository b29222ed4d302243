// The structure function that knows its noise, and the choice among laws: times, and (BENCHMARK "accuracy…", "choice…",
// "theory…") errors and choices on exact surfaces. docs/fractal.md quotes it.

#include <algorithm>
#include <array>
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "fractal/lag_fit.hpp"
#include "fractal/scale_laws.hpp"
#include "fractal/structure_dimension.hpp"
#include "fractal/surface.hpp"
#include "tests/fractal/composite_surfaces.hpp"

namespace {

using namespace scree::fractal;

/// 3277 of 256² cells, or all of them. Noise in units of the rms change over the mean spacing, with a tilt; or that of
/// [AK96] Table 1: heights 73.9 cells rms, `table_cells` of noise in x, y and z.
struct Ground {
  int count = 3277;
  double noise = 0.0, tilt = 0.0, table_cells = 0.0;
};

struct Survey {
  std::vector<double> x, y, z;
  double noise = 0.0, noise_xy = 0.0;
  SurveyPoints points() const {
    return {.x_m = x, .y_m = y, .z_m = z, .noise_sigma_m = noise, .noise_xy_sigma_m = noise_xy};
  }
};

double rms(const scree::Grid<float>& z) {
  double sum = 0.0, sum2 = 0.0;
  for (const float value : z) sum += value, sum2 += double{value} * value;
  const double n = static_cast<double>(z.size());
  return std::sqrt(sum2 / n - sum * sum / (n * n));
}

Survey survey_of(const Ground& ground, double dimension, std::uint64_t seed) {
  constexpr int kSide = 256;
  const double cell = ground.table_cells > 0.0 ? 1.0 : std::sqrt(double{1} * ground.count) / kSide;
  const auto surface = *fbm_surface({dimension, 1.0}, kSide, kSide, cell, seed);
  const double scale = ground.table_cells > 0.0 ? 73.9 / rms(surface) : 1.0;
  Survey out;
  out.noise = ground.noise + ground.table_cells;
  out.noise_xy = ground.table_cells;
  double wanted = ground.count, left = kSide * kSide;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c, --left) {
      if (scree::to_uniform(scree::random_words(seed, 5, c, r)[0]) * left >= wanted) continue;
      --wanted;
      const auto height = scree::random_normals(seed, 6, c, r), place = scree::random_normals(seed, 7, c, r);
      out.x.push_back(cell * c + out.noise_xy * place[0]);
      out.y.push_back(cell * r + out.noise_xy * place[1]);
      out.z.push_back(scale * surface(r, c) + out.noise * height[0] + ground.tilt * cell * c);
    }
  return out;
}

void accuracy(benchmark::State& state, const Ground& ground) {
  const double dimension = static_cast<double>(state.range(0)) / 100.0;
  const auto surfaces = static_cast<int>(state.range(1));
  scree::SerialExecutor serial;
  double bias = 0.0, square = 0.0, covered = 0.0;
  for (auto _ : state)
    for (int k = 0; k < surfaces; ++k) {
      const auto found = *estimate_dimension_structure(
          survey_of(ground, dimension, static_cast<std::uint64_t>(k)).points(), {}, serial);
      const double error = found.dimension - dimension;
      bias += error / surfaces;
      square += error * error / surfaces;
      if (found.interval95.low <= dimension && dimension <= found.interval95.high) covered += 1.0 / surfaces;
    }
  state.counters["bias"] = bias;
  state.counters["rmse"] = std::sqrt(square);
  state.counters["bias_percent"] = 100.0 * bias / dimension;
  state.counters["rmse_percent"] = 100.0 * std::sqrt(square) / dimension;
  state.counters["coverage"] = covered;
}
const std::vector<std::vector<std::int64_t>> kDimensions{{205, 220, 240, 260, 280, 290}, {100}};
BENCHMARK_CAPTURE(accuracy, clean, Ground{})->ArgsProduct(kDimensions)->Iterations(1);
BENCHMARK_CAPTURE(accuracy, tilt_noise, (Ground{3277, 0.3, 0.5, 0.0}))->ArgsProduct(kDimensions)->Iterations(1);
BENCHMARK_CAPTURE(accuracy, table_30dB, (Ground{3277, 0.0, 0.0, 2.34}))
    ->ArgsProduct({{210, 220, 230, 240, 250, 260, 270, 280}, {100}})
    ->Iterations(1);
BENCHMARK_CAPTURE(accuracy, table_20dB, (Ground{3277, 0.0, 0.0, 7.39}))
    ->ArgsProduct({{210, 220, 230, 240, 250, 260, 270, 280}, {100}})
    ->Iterations(1);
BENCHMARK_CAPTURE(accuracy, raster, (Ground{65536, 0.0, 0.0, 0.0}))
    ->ArgsProduct({{210, 220, 250, 280}, {60}})
    ->Iterations(1);

void choice(benchmark::State& state, const Composite& composite) {
  const auto surfaces = static_cast<int>(state.range(0));
  scree::SerialExecutor serial;
  std::array<double, 4> counts{};
  double bias = 0.0, square = 0.0, right = 0.0, covered = 0.0, crossover = 0.0, crossover2 = 0.0;
  for (auto _ : state)
    for (int k = 0; k < surfaces; ++k) {
      const Raster raster = composite_raster(composite, 256, static_cast<std::uint64_t>(k));
      const auto found = *analyse_scales(raster.survey(), {}, serial);
      counts[found.chosen] += 1.0;
      if (found.best().law != composite.truth) continue;
      const double truth = 3.0 - composite.hurst, error = truth - found.best().dimension;
      const double off = std::log(found.best().crossover_m / composite.crossover);
      crossover += off, crossover2 += off * off;
      right += 1.0, bias += error, square += error * error;
      if (found.best().interval95.low <= truth && truth <= found.best().interval95.high) covered += 1.0;
    }
  for (const auto law : {ScaleLaw::power, ScaleLaw::power_and_noise, ScaleLaw::two_scales, ScaleLaw::plateau})
    state.counters[std::string(scale_law_name(law))] = counts[static_cast<std::size_t>(law)];
  right = std::max(right, 1.0);
  state.counters["H_bias"] = bias / right;
  state.counters["H_rmse"] = std::sqrt(square / right);
  state.counters["coverage"] = covered / right;
  if (composite.truth != ScaleLaw::two_scales) return;
  state.counters["log_crossover_bias"] = crossover / right;
  state.counters["log_crossover_rmse"] = std::sqrt(crossover2 / right);
}
BENCHMARK_CAPTURE(choice, power_2, (Composite{ScaleLaw::power, 0.2}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, power_5, (Composite{ScaleLaw::power, 0.5}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, power_8, (Composite{ScaleLaw::power, 0.8}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, two_20_80, (Composite{ScaleLaw::two_scales, 0.2}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, two_35_80, (Composite{ScaleLaw::two_scales, 0.35}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, noise_65, (Composite{ScaleLaw::power_and_noise, 0.65}))->Arg(100)->Iterations(1);
BENCHMARK_CAPTURE(choice, plateau_65, (Composite{ScaleLaw::plateau, 0.65}))->Arg(100)->Iterations(1);

/// Errors of ln S at the true law over surfaces, against the theory: ratio of standard deviations, smallest and largest
/// over the lags; mean offset of S itself; mean chi-square a lag with the weights in use.
void theory(benchmark::State& state, const Ground& ground) {
  const double hurst = 3.0 - static_cast<double>(state.range(0)) / 100.0;
  const auto surfaces = static_cast<int>(state.range(1));
  scree::SerialExecutor serial;
  Eigen::VectorXd sum, sum2, ratio, sigma;
  double chi_square = 0.0;
  for (auto _ : state)
    for (int k = 0; k < surfaces; ++k) {
      const Survey survey = survey_of(ground, 3.0 - hurst, static_cast<std::uint64_t>(k));
      const auto statistics = *lag_statistics(survey.points(), {}, serial);
      const LagModel model(statistics);
      const double change = std::pow(statistics.spacing_m, hurst) / statistics.height_m;
      const GroundLaw law{{change * change, hurst}, {}, 0.0, statistics.noise_variance, statistics.blur};
      const Eigen::VectorXd expected = model.expected(law);
      if (k == 0) sum = sum2 = ratio = Eigen::VectorXd::Zero(expected.size());
      if (k == 0) sigma = model.covariance(law).diagonal().cwiseSqrt();
      Eigen::VectorXd error(expected.size());
      for (Eigen::Index l = 0; l < error.size(); ++l)
        error[l] = statistics.lags[static_cast<std::size_t>(l)].log_square - std::log(expected[l]);
      sum += error, sum2 += error.cwiseAbs2(), ratio += (error.array().exp() - 1.0).matrix() / surfaces;
      LagFit fit(statistics);
      fit.weigh(model, law);
      chi_square += fit.residual(expected.array().log()).squaredNorm() / surfaces / static_cast<double>(error.size());
    }
  const Eigen::ArrayXd variance = (sum2.array() - sum.array().square() / surfaces) / (surfaces - 1);
  const Eigen::ArrayXd against = variance.sqrt() / sigma.array();
  state.counters["sd_ratio_least"] = against.minCoeff();
  state.counters["sd_ratio_most"] = against.maxCoeff();
  state.counters["offset_least"] = ratio.minCoeff();
  state.counters["offset_most"] = ratio.maxCoeff();
  state.counters["chi_square_a_lag"] = chi_square;
}
const std::vector<std::vector<std::int64_t>> kTheory{{220, 250, 280}, {100}};
BENCHMARK_CAPTURE(theory, raster, (Ground{65536, 0.0, 0.0, 0.0}))->ArgsProduct(kTheory)->Iterations(1);
BENCHMARK_CAPTURE(theory, points, Ground{})->ArgsProduct(kTheory)->Iterations(1);
BENCHMARK_CAPTURE(theory, noise, (Ground{3277, 0.3, 0.0, 0.0}))->ArgsProduct(kTheory)->Iterations(1);

void structure_dimension(benchmark::State& state) {
  scree::SerialExecutor serial;
  const Survey survey = survey_of({static_cast<int>(state.range(0)), 0.3, 0.5, 0.0}, 2.4, 1);
  for (auto _ : state) benchmark::DoNotOptimize(estimate_dimension_structure(survey.points(), {}, serial));
}
BENCHMARK(structure_dimension)->Arg(100)->Arg(3277)->Arg(65536)->Unit(benchmark::kMillisecond);

void scale_laws(benchmark::State& state) {
  scree::SerialExecutor serial;
  const Survey survey = survey_of({static_cast<int>(state.range(0)), 0.3, 0.5, 0.0}, 2.4, 1);
  for (auto _ : state) benchmark::DoNotOptimize(analyse_scales(survey.points(), {}, serial));
}
BENCHMARK(scale_laws)->Arg(3277)->Arg(65536)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
