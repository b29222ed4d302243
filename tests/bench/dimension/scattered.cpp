// One D for 3277 scattered points without noise: error against the Cramér–Rao bound, coverage, invariances.

#include <array>

#include "fractal/loglog_fit.hpp"
#include "fractal/vecchia.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.05, 2.2, 2.4, 2.6, 2.8, 2.9};
/// Standard deviations that no unbiased estimator undercuts: 3277 of 256 × 256, clean, plane unknown.
constexpr std::array kBound = {.0157, .0151, .0140, .0125, .0099, .0075};
constexpr std::array kBoundFactor = {1.5, 1.25, 1.25, 1.25, 1.25, 1.25};
constexpr double kTilt = 0.5;

struct Judged {
  DimensionEstimate estimate;
  double papers = 0.0;
};

struct Column {
  Errors clean, papers;
  double scale_dependent = 0.0;
};

Column judge(std::size_t c) {
  const int count = surfaces(c == 0 ? 400 : 600);
  const double cell = std::sqrt(static_cast<double>(kPaperPoints)) / kPaperSide;
  constexpr int kPapers = 60;
  const auto all = over_surfaces(count, [&](int i) {
    Survey survey = exact_survey(kDimensions[c], static_cast<std::uint64_t>(i));
    Judged out;
    if (i < kPapers)
      out.papers = first_moment_dimension(survey, uniform_annuli(cell, 128.0 * cell), {.route = PairRoute::all_pairs});
    add_plane(survey, kTilt, 0.0);
    out.estimate = *estimate_dimension_vecchia(survey.points());
    return out;
  });
  Column column;
  for (std::size_t i = 0; i < all.size(); ++i) {
    column.clean.add(all[i].estimate, kDimensions[c]);
    if (i < kPapers) column.papers.add(all[i].papers - kDimensions[c]);
    column.scale_dependent += all[i].estimate.flags & kScaleDependent ? 1.0 : 0.0;
  }
  return column;
}

/// The largest change of D over all D of the table, with and without noise.
struct Invariance {
  double plane = 0.0, scale = 0.0;
};

Invariance invariances(double noise) {
  Invariance most;
  for (const double dimension : kDimensions) {
    const auto found = over_surfaces(surfaces(10), [&](int i) {
      Survey level = exact_survey(dimension, static_cast<std::uint64_t>(i));
      add_noise(level, noise, 0.0, static_cast<std::uint64_t>(i));
      const double d = estimate_dimension_vecchia(level.points(noise))->dimension;
      Invariance change;
      for (const double slope : {0.5, -30.0, 1000.0}) {
        Survey tilted = level;
        add_plane(tilted, slope, -0.7 * slope);
        change.plane =
            std::max(change.plane, std::abs(estimate_dimension_vecchia(tilted.points(noise))->dimension - d));
      }
      for (double& z : level.z) z *= 10.0;
      change.scale = std::abs(estimate_dimension_vecchia(level.points(10.0 * noise))->dimension - d);
      return change;
    });
    for (const Invariance& one : found) {
      most.plane = std::max(most.plane, one.plane);
      most.scale = std::max(most.scale, one.scale);
    }
  }
  return most;
}

}  // namespace

void scattered_section() {
  print_text(R"(## 3277 scattered points, clean

3277 random cells of 256 × 256 cells of exact surfaces, 400 surfaces at D = 2.05, 600 elsewhere (standard error of an
RMSE 3.5 and 2.9 %, of a coverage .011 and .009); slope .5 added; unit the mean spacing. The paper's estimator (first
absolute moment, lags 1 … 128 cells, one unweighted line) on 60 of the same surfaces, level.
)");
  std::array<Column, kDimensions.size()> columns;
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = judge(c);
  print_head("Vecchia", kDimensions);
  const auto row = [&](const char* name, auto cell) { print_row(name, columns.size(), cell); };
  row("bias", [&](std::size_t c) { return with_sign(columns[c].clean.mean()); });
  row("RMSE", [&](std::size_t c) { return fixed(columns[c].clean.rms()); });
  row("Cramér–Rao bound", [&](std::size_t c) { return fixed(kBound[c]); });
  row("RMSE / bound", [&](std::size_t c) { return fixed(columns[c].clean.rms() / kBound[c], 2); });
  row("target", [&](std::size_t c) { return fmt::format("{:g}", kBoundFactor[c]); });
  row("", [&](std::size_t c) { return at_most(columns[c].clean.rms() / kBound[c], kBoundFactor[c]); });
  row("95 % interval covers", [&](std::size_t c) { return fixed(columns[c].clean.coverage(), 3); });
  row("target .92 – .98", [&](std::size_t c) {
    return kDimensions[c] < 2.2 ? std::string("none") : within(columns[c].clean.coverage(), .92, .98);
  });
  row("flagged scale_dependent",
      [&](std::size_t c) { return fixed(columns[c].scale_dependent / columns[c].clean.count, 3); });
  row("paper's estimator, RMSE", [&](std::size_t c) { return fixed(columns[c].papers.rms()); });
  row("its RMSE / ours", [&](std::size_t c) { return fixed(columns[c].papers.rms() / columns[c].clean.rms(), 1); });
  row("target 2.5", [&](std::size_t c) { return at_least(columns[c].papers.rms() / columns[c].clean.rms(), 2.5); });

  print_text(
      "\nLargest change of D over 10 surfaces a D, slopes .5 … 1000 of the rms change, heights (and noise) times "
      "10:\n");
  print_text("| | slope | target | | heights times 10 | target | |\n|---|---|---|---|---|---|---|");
  for (const double noise : {0.0, 0.3}) {
    const Invariance most = invariances(noise);
    print_text(fmt::format("| {} | {:.1e} | 1e-6 | {} | {:.1e} | 1e-6 | {} |", noise > 0.0 ? "noise .3 known" : "clean",
                           most.plane, at_most(most.plane, 1e-6), most.scale, at_most(most.scale, 1e-6)));
  }
}

}  // namespace scree::bench
