// The outlier gate: what it finds, what it takes for an outlier, what that does to the mean.

#include <array>

#include "fractal/reconstruction/outlier_gate.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/broken_scene.hpp"
#include "tests/reconstruction/outlier_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.5, 2.7, 2.8};
constexpr int kSide = 256;

struct Gate {
  double plain = 0.0, gated = 0.0, told = 0.0;              // squared errors
  double wrong = 0.0, found = 0.0, good = 0.0, lost = 0.0;  // data
  double worst = 0.0;                                       // gated over told, of one scene

  void add(const Gate& one) {
    plain += one.plain, gated += one.gated, told += one.told;
    wrong += one.wrong, found += one.found, good += one.good, lost += one.lost;
    worst = std::max(worst, std::sqrt(one.gated / one.told));
  }
};

Gate judge(double dimension, double density, std::uint64_t seed) {
  const OutlierScene scene(dimension, kSide, kSide, density, seed);
  const OutlierReport report = find_outliers(scene.samples, kSceneCellM, {scene.law, {}, {}});
  Gate gate;
  for (std::size_t i = 0; i < report.rejected.size(); ++i) {
    if (std::isnan(scene.height[i])) continue;
    (scene.wrong[i] != 0 ? gate.wrong : gate.good) += 1.0;
    (scene.wrong[i] != 0 ? gate.found : gate.lost) += report.rejected[i];
  }
  gate.plain = std::pow(rmse_of_mean(scene, scene.samples), 2);
  gate.told = std::pow(rmse_of_mean(scene, scene.told), 2);
  gate.gated = std::pow(rmse_of_mean(scene, without_outliers(scene.samples, report)), 2);
  return gate;
}

/// Share of the data that go though none is wrong, told `factor` times the amplitude.
double lost_of_clean(double dimension, double density, double factor) {
  double tested = 0.0, lost = 0.0;
  for (const auto& [all, rejected] : over_surfaces(surfaces(20), [&](int i) {
         const SparseScene scene(dimension, kSide, kSide, density, static_cast<std::uint64_t>(i));
         FractalLaw law = scene.law;
         law.amplitude_m *= factor;
         const OutlierReport report = find_outliers(cells_of(scene), kSceneCellM, {law, {}, {}});
         return std::pair{static_cast<double>(report.tested), static_cast<double>(report.count)};
       })) {
    tested += all;
    lost += rejected;
  }
  return lost / tested;
}

struct Broken {
  double near = 0.0, near_lost = 0.0, away = 0.0, away_lost = 0.0;
  double near_plain = 0.0, near_gated = 0.0, away_plain = 0.0, away_gated = 0.0, near_cells = 0.0, away_cells = 0.0;
};

Broken judge_broken(double dimension, double density, std::uint64_t seed) {
  const BrokenScene scene(dimension, kSide, kSide, density, seed);
  const CellSamples samples = cells_of(scene);
  const OutlierReport report = find_outliers(samples, kSceneCellM, {scene.law, {}, {}});
  const CellSamples left = without_outliers(samples, report);
  ConditionalReconstructor reconstructor({.cell_m = kSceneCellM, .max_cells = kSide});
  SerialExecutor serial;
  Reconstruction plain, gated;
  reconstructor.reconstruct(samples.height_m, samples.variance_m2, scene.window(), scene.law, serial, plain);
  reconstructor.reconstruct(left.height_m, left.variance_m2, scene.window(), scene.law, serial, gated);
  const double unit2 = std::pow(scene.law.rms_change_m(kSceneCellM), 2);
  Broken broken;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const bool near = scene.near(r, c);
      if (!std::isnan(scene.height(r, c))) {
        (near ? broken.near : broken.away) += 1.0;
        (near ? broken.near_lost : broken.away_lost) += report.rejected(r, c);
        continue;
      }
      const double before = std::pow(static_cast<double>(plain.mean_m(r, c) - scene.truth(r, c)), 2) / unit2;
      const double after = std::pow(static_cast<double>(gated.mean_m(r, c) - scene.truth(r, c)), 2) / unit2;
      (near ? broken.near_cells : broken.away_cells) += 1.0;
      (near ? broken.near_plain : broken.away_plain) += before;
      (near ? broken.near_gated : broken.away_gated) += after;
    }
  return broken;
}

void print_outliers(double density) {
  print_text(fmt::format("\n{:g} % of the cells measured.\n", 100 * density));
  std::array<Gate, kDimensions.size()> gates;
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const Gate& one : over_surfaces(
             surfaces(20), [&](int i) { return judge(kDimensions[d], density, static_cast<std::uint64_t>(i)); }))
      gates[d].add(one);
  print_head("", kDimensions);
  const auto row = [&](const std::string& name, auto cell) {
    print_row(name, gates.size(), [&](std::size_t d) { return cell(gates[d], d); });
  };
  const auto scenes = static_cast<double>(surfaces(20));
  row("RMSE with all data", [&](const Gate& g, std::size_t) { return fixed(std::sqrt(g.plain / scenes), 3); });
  row("gated", [&](const Gate& g, std::size_t) { return fixed(std::sqrt(g.gated / scenes), 3); });
  row("told which are wrong", [&](const Gate& g, std::size_t) { return fixed(std::sqrt(g.told / scenes), 3); });
  row("gated/told", [](const Gate& g, std::size_t) { return fixed(std::sqrt(g.gated / g.told), 3); });
  row("… target ≤ 1.03", [](const Gate& g, std::size_t) { return at_most(std::sqrt(g.gated / g.told), 1.03); });
  row("gated/told, worst scene", [](const Gate& g, std::size_t) { return fixed(g.worst, 3); });
  row("wrong data found, %", [](const Gate& g, std::size_t) { return fixed(100.0 * g.found / g.wrong, 1); });
  row("good data lost, %", [](const Gate& g, std::size_t) { return fixed(100.0 * g.lost / g.good, 4); });
  for (const double factor : {1.0, 0.7, 0.5})
    row(fmt::format("lost without outliers, %, amplitude told {:g} of the true", factor),
        [&](const Gate&, std::size_t d) { return fixed(100.0 * lost_of_clean(kDimensions[d], density, factor), 4); });
}

}  // namespace

void outliers_section() {
  print_text(R"(
## Outliers

256 × 256 cells of exact surfaces, noise variance 1e-3 of the squared change over one cell; 3 % of the data are off by
8 … 25 changes over one cell, up or down. 20 scenes a column, RMSE of the mean over the cells without a datum in units
of the change over one cell.
)");
  for (const double density : {0.05, 0.2}) print_outliers(density);
  print_text(R"(
Ground with a cliff of 25 changes and 5 rocks of 10 … 20, no outliers, 5 % measured with noise variance 1e-2; near:
within four cells of such an edge. 20 scenes a column.
)");
  constexpr std::array<double, 3> kBroken = {2.3, 2.5, 2.7};
  std::array<Broken, 3> sums;
  for (std::size_t d = 0; d < kBroken.size(); ++d)
    for (const Broken& one : over_surfaces(
             surfaces(20), [&](int i) { return judge_broken(kBroken[d], 0.05, static_cast<std::uint64_t>(i)); })) {
      Broken& s = sums[d];
      s.near += one.near, s.near_lost += one.near_lost, s.away += one.away, s.away_lost += one.away_lost;
      s.near_plain += one.near_plain, s.near_gated += one.near_gated, s.near_cells += one.near_cells;
      s.away_plain += one.away_plain, s.away_gated += one.away_gated, s.away_cells += one.away_cells;
    }
  print_head("", kBroken);
  const auto row = [&](const std::string& name, auto cell) {
    print_row(name, sums.size(), [&](std::size_t d) { return cell(sums[d]); });
  };
  row("data lost near, %", [](const Broken& s) { return fixed(100.0 * s.near_lost / s.near, 1); });
  row("data lost away, %", [](const Broken& s) { return fixed(100.0 * s.away_lost / s.away, 3); });
  row("RMSE near, all data", [](const Broken& s) { return fixed(std::sqrt(s.near_plain / s.near_cells), 3); });
  row("RMSE near, gated", [](const Broken& s) { return fixed(std::sqrt(s.near_gated / s.near_cells), 3); });
  row("RMSE away, all data", [](const Broken& s) { return fixed(std::sqrt(s.away_plain / s.away_cells), 3); });
  row("RMSE away, gated", [](const Broken& s) { return fixed(std::sqrt(s.away_gated / s.away_cells), 3); });
  const OutlierScene few(2.5, kSide, kSide, 0.05, 1), many(2.5, kSide, kSide, 0.2, 1);
  const auto times = times_of({[&] {
                                 find_outliers(few.samples, kSceneCellM, {few.law, {}, {}});
                               },
                               [&] {
                                 find_outliers(many.samples, kSceneCellM, {many.law, {}, {}});
                               }});
  print_text(
      fmt::format("\nTime of the gate at 256 × 256, D = 2.5, one core: {:.1f} ms with 5 % measured, {:.1f} ms "
                  "with 20 %.",
                  times[0].cpu_ms, times[1].cpu_ms));
}

}  // namespace scree::bench
