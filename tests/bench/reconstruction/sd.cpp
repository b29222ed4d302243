// The standard deviation of every cell from a few residual fields, against that of many.

#include <array>

#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/reconstruction/sd_map.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/outlier_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr int kSide = 256, kReference = 256, kTested = 64;

struct Case {
  std::string name;
  double dimension;  ///< 0: D 2.15 and little on the left, 2.6 and five times the amplitude on the right
  double density;
  bool holes;
  double noise = 0.0316;
};

struct LogErrors {
  double square = 0.0, cells = 0.0;
  void add(double log_error) {
    square += log_error * log_error;
    cells += 1.0;
  }
  /// Without what the reference itself errs by.
  double rms() const { return std::sqrt(std::max(square / cells - 1.0 / (2.0 * kReference), 0.0)); }
};

LawMap law_of(const Case& which, const FractalLaw& law) {
  if (which.dimension > 0.0) return {law, {}, {}};
  LawMap map{{2.4, 0.2}, Grid<float>(kSide, kSide), Grid<float>(kSide, kSide)};
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double share = 0.5 + 0.5 * std::erf((c - 0.5 * kSide) / 11.0);
      const double dimension = 2.15 + 0.45 * share, change = 0.3 * std::pow(5.0, share);
      map.dimension(r, c) = static_cast<float>(dimension);
      map.amplitude_m(r, c) = static_cast<float>(change / std::pow(kSceneCellM, 3.0 - dimension));
    }
  map.law.amplitude_m = 0.67 / std::pow(kSceneCellM, 0.6);
  return map;
}

CellSamples samples_of(const Case& which, const FractalLaw& law, double unit_m) {
  SparseScene scene(law.dimension, kSide, kSide, which.density, 11, which.noise);
  CellSamples samples = cells_of(scene);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      if (std::isnan(samples.height_m(r, c))) continue;
      samples.height_m(r, c) = 0.0F;  // residuals do not depend on it
      samples.variance_m2(r, c) = static_cast<float>(std::pow(which.noise * unit_m, 2));
      for (int hole = 0; which.holes && hole < 12; ++hole) {
        const auto words = random_words(77, 1, hole, 0);
        if (std::hypot(r - kSide * to_uniform(words[1]), c - kSide * to_uniform(words[0])) <
            8 + 17 * to_uniform(words[2]))
          samples.height_m(r, c) = samples.variance_m2(r, c) = NAN;
      }
    }
  samples.cells = 0;
  for (const float z : samples.height_m) samples.cells += std::isnan(z) ? 0 : 1;
  return samples;
}

struct Outcome {
  std::array<LogErrors, 3> raw, map, raw_measured, map_measured;  // K = 4, 8, 16
  LogErrors left, middle, right;                                  // K = 8, by column
};
constexpr std::array kFields = {4, 8, 16};

Outcome judge(const Case& which) {
  const FractalLaw law{which.dimension > 0.0 ? which.dimension : 2.4, kSceneAmplitudeM};
  SurfaceRequest request;
  request.grid = {kSide, kSide, kSceneCellM};
  request.law = law_of(which, law);
  const CellSamples samples = samples_of(which, law, request.law.law.rms_change_m(kSceneCellM));
  std::vector<Grid<float>> residuals;
  request.draws = kReference + kTested;
  request.on_draw = [&](int, const Grid<float>& draw) { residuals.push_back(draw); };  // the mean is 0
  SerialExecutor serial;
  const auto estimate = reconstruct_conditional(samples, request, {.tolerance = 0.02, .gate_outliers = false}, serial);
  if (!estimate) {
    std::fprintf(stderr, "sd: %s\n", estimate.error().message.c_str());
    return {};
  }
  const auto mean_square = [&](int first, int count) {
    Grid<float> square(kSide, kSide, 0.0F);
    for (int k = first; k < first + count; ++k)
      for (std::size_t i = 0; i < square.size(); ++i)
        square[i] += residuals[static_cast<std::size_t>(k)][i] * residuals[static_cast<std::size_t>(k)][i] /
                     static_cast<float>(count);
    return square;
  };
  const Grid<float> truth = mean_square(kTested, kReference);
  Outcome outcome;
  SdMap map;
  Grid<float> sd;
  for (std::size_t f = 0; f < kFields.size(); ++f)
    for (int first = 0; first + kFields[f] <= kTested; first += kFields[f]) {
      const Grid<float> few = mean_square(first, kFields[f]);
      map.estimate(few, kFields[f], samples.variance_m2, request.law, kSceneCellM, serial, sd);
      for (int r = 0; r < kSide; ++r)
        for (int c = 0; c < kSide; ++c) {
          const double reference = 0.5 * std::log(static_cast<double>(truth(r, c)));
          const double raw = 0.5 * std::log(static_cast<double>(few(r, c))) - reference;
          const double error = std::log(static_cast<double>(sd(r, c))) - reference;
          const bool measured = !std::isnan(samples.height_m(r, c));
          (measured ? outcome.raw_measured : outcome.raw)[f].add(raw);
          (measured ? outcome.map_measured : outcome.map)[f].add(error);
          if (f == 1 && !measured)
            (c < kSide / 2 - 16 ? outcome.left : c < kSide / 2 + 16 ? outcome.middle : outcome.right).add(error);
        }
    }
  return outcome;
}

}  // namespace

void sd_section() {
  print_text(R"(
## Standard deviation of every cell

rms error of log sd, 256 × 256 cells, against the mean square of 256 other residual fields (whose own error, .044, is
taken off); noise variance 1e-3 of the squared change over one cell unless said. Raw: the root of the mean square of K
fields. Holes: 12 discs of radius 8 … 25 cells without data.

| case | raw, K = 8 | K = 4 | K = 8 | K = 16 | target ≤ .09 at K = 8 | raw at data, K = 8 | at data, K = 8 |
|---|---|---|---|---|---|---|---|)");
  std::vector<Case> cases;
  for (const bool holes : {false, true})
    for (const double dimension : {2.3, 2.5, 2.7})
      cases.push_back({fmt::format("D {:g}, 5 %{}", dimension, holes ? ", holes" : ""), dimension, 0.05, holes});
  cases.push_back({"D 2.5, 1 %", 2.5, 0.01, false});
  cases.push_back({"D 2.5, 20 %", 2.5, 0.2, false});
  cases.push_back({"D 2.5, 20 %, noise variance 1", 2.5, 0.2, false, 1.0});
  cases.push_back({"D 2.4, 95 %, noise variance 4", 2.4, 0.95, false, 2.0});
  cases.push_back({"D 2.15 to 2.6, 5 %", 0.0, 0.05, false});
  cases.push_back({"D 2.15 to 2.6, 5 %, holes", 0.0, 0.05, true});
  const int count = quick ? 2 : static_cast<int>(cases.size());
  const auto outcomes = over_surfaces(count, [&](int i) { return judge(cases[static_cast<std::size_t>(i)]); });
  for (int i = 0; i < count; ++i) {
    const Outcome& o = outcomes[static_cast<std::size_t>(i)];
    print_text(fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {} | {:.3f} | {:.3f} |",
                           cases[static_cast<std::size_t>(i)].name, o.raw[1].rms(), o.map[0].rms(), o.map[1].rms(),
                           o.map[2].rms(), at_most(o.map[1].rms(), 0.09), o.raw_measured[1].rms(),
                           o.map_measured[1].rms()));
  }
  print_text(
      "\nA law that varies, K = 8, by zone:\n\n| case | D 2.15 | transition, 32 cells | D 2.6 |\n|---|---|---|---|");
  for (int i = 0; i < count; ++i)
    if (cases[static_cast<std::size_t>(i)].dimension == 0.0) {
      const Outcome& o = outcomes[static_cast<std::size_t>(i)];
      print_text(fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} |", cases[static_cast<std::size_t>(i)].name, o.left.rms(),
                             o.middle.rms(), o.right.rms()));
    }
  const FractalLaw law{2.5, kSceneAmplitudeM};
  const CellSamples samples = samples_of(cases[1], law, law.rms_change_m(kSceneCellM));
  const LawMap one{law, {}, {}}, varying = law_of({"", 0.0, 0.05, false}, law);
  const Grid<float> square(kSide, kSide, 0.01F);
  SdMap map;
  Grid<float> sd;
  SerialExecutor serial;
  const auto times =
      times_of({[&] { map.estimate(square, 8, samples.variance_m2, one, kSceneCellM, serial, sd); },
                [&] { map.estimate(square, 8, samples.variance_m2, varying, kSceneCellM, serial, sd); }});
  print_text(fmt::format("\nTime at 256 × 256, one core: {:.2f} ms for one law, {:.2f} ms for one a cell.",
                         times[0].cpu_ms, times[1].cpu_ms));
}

}  // namespace scree::bench
