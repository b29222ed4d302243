// The point of it all: how well cost and risk tell the cells that the true ground makes impassable.

#include <span>

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"

namespace scree::bench {
namespace {

ScoreCounts pooled(const Scenes& scenes, CellClass kind, Method method) {
  ScoreCounts sum;
  for (const Judgement* scene : scenes) sum += scene->scores[kind][method];
  return sum;
}

double auc(const Scenes& scenes, CellClass kind, Method method) {
  const ScoreCounts counts = pooled(scenes, kind, method);
  return counts.cells() > 0.0 ? counts.auc() : std::nan("");
}

std::string number(double value, int digits = 3) {
  return std::isnan(value) ? "—" : fixed(value, digits);
}

Interval gain(const Scenes& scenes, CellClass kind, Method ours, Method theirs) {
  return bootstrap(scenes, [&](const Scenes& s) { return auc(s, kind, ours) - auc(s, kind, theirs); });
}

/// The better judge of ours: the risk, where there is one.
Method ours(const Scenes& scenes, CellClass kind) {
  return pooled(scenes, kind, kRisk).cells() > 0.0 ? kRisk : kCost;
}

void auc_row(const std::string& name, const Scenes& scenes, CellClass kind) {
  const ScoreCounts counts = pooled(scenes, kind, kCost);
  if (counts.cells() == 0.0) return;
  std::string line = fmt::format("| {} | {:.0f} | {:.0f} % |", name, counts.cells(), 100.0 * counts.share_impassable());
  for (const Method m : {kCost, kRisk, kRelief, kPlane, kFootprint, kCeiling})
    line += fmt::format(" {} |", number(auc(scenes, kind, m)));
  for (const Method theirs : {kRelief, kPlane})
    line += fmt::format(" {} |", signed_interval_text(gain(scenes, kind, kCost, theirs)));
  print_text(line);
}

void auc_table(const SensorResults& r, CellClass kind) {
  print_text(
      "\n| D | cells | impassable | cost | risk | fill, relief | slope, step, roughness | fill, footprint | true "
      "cells, footprint | cost less "
      "relief (95 %) | cost less slope, step, roughness (95 %) |\n|---|---|---|---|---|---|---|---|---|---|---|");
  for (const double d : kDimensions)
    if (const Scenes scenes = scenes_of(r.scenes, d); !scenes.empty()) auc_row(fixed(d, 1), scenes, kind);
  auc_row("all", scenes_of(r.scenes), kind);
}

double brier_of(const Scenes& scenes, Method method, const Calibration& calibration) {
  const ScoreCounts counts = pooled(scenes, kAllCells, method);
  return counts.cells() > 0.0 ? brier(counts, calibration) : std::nan("");
}

void brier_row(const std::string& name, const Scenes& scenes, const SensorResults& r) {
  const double share = pooled(scenes, kAllCells, kCost).share_impassable();
  const Method best = ours(scenes, kAllCells);
  std::string line = fmt::format("| {} | {} | {} |", name, number(share * (1.0 - share), 4),
                                 number(brier_of(scenes, kRisk, as_it_is()), 4));
  for (const Method m : {kRisk, kCost, kRelief, kPlane, kFootprint, kCeiling})
    line += fmt::format(" {} |", number(brier_of(scenes, m, r.calibration[m]), 4));
  for (const Method theirs : {kRelief, kPlane}) {
    const Interval less = bootstrap(scenes, [&](const Scenes& drawn) {
      return brier_of(drawn, best, r.calibration[best]) - brier_of(drawn, theirs, r.calibration[theirs]);
    });
    line += fmt::format(" {} |", signed_interval_text(less, 4));
  }
  print_text(line);
}

void brier_table(const SensorResults& r) {
  print_text(
      "\n| D | the share alone | risk as it is | risk | cost | fill, relief | slope, step, roughness | fill, footprint "
      "| true cells, footprint "
      "| ours less relief (95 %) | ours less slope, step, roughness (95 %) "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|");
  for (const double d : kDimensions)
    if (const Scenes scenes = scenes_of(r.scenes, d); !scenes.empty()) brier_row(fixed(d, 1), scenes, r);
  brier_row("all", scenes_of(r.scenes), r);
}

/// In words: where the lower end of the interval of the gain is above zero for both baselines.
void verdict(const SensorResults& r, CellClass kind, Method method, const char* what) {
  if (pooled(scenes_of(r.scenes), kind, method).cells() == 0.0) return;
  std::string better, not_better;
  for (const double d : kDimensions) {
    const Scenes scenes = scenes_of(r.scenes, d);
    if (scenes.empty()) continue;
    const Interval relief = gain(scenes, kind, method, kRelief), plane = gain(scenes, kind, method, kPlane);
    const Interval& least = relief.value < plane.value ? relief : plane;
    std::string& list = std::min(relief.low, plane.low) > 0.0 ? better : not_better;
    list += fmt::format("{}{:.1f} ({:+.3f})", list.empty() ? "" : ", ", d, least.value);
  }
  print_text(
      fmt::format("\n{}, area under the ROC less that of the better baseline: better than both (95 %) at D = {}; "
                  "**not so** at D = {}.",
                  what, better.empty() ? "none" : better, not_better.empty() ? "none" : not_better));
}

}  // namespace

void separation_section() {
  print_text(R"(
## Impassable cells

Does the score tell the cells that the true ground makes impassable at the worst heading? Cells with a cost (a possible drop
has 254, and risk 1), the same for every method. Area under the ROC: the chance that an impassable cell scores worse than a
passable one; pooled over the scenes of a D, 95 % intervals by drawing scenes again, differences paired. A cost has ties where
a risk has none: everything lethal is 254.

*fill, relief*: mean of the returns of a cell, gaps filled by a membrane, highest less lowest height around the cell. *slope,
step, roughness*: the rules of traversability_estimation on the same filled ground. Windows, critical values and weights of
both are the best of a search on grounds of their own, for each sensor. *fill, footprint*: the vehicle of the truth put onto the
filled ground: no baseline that is in use, but what the footprint alone brings. *true cells, footprint*: the same on the true
mean heights of the cells: the most that a perfect map of 0.1 m cells could know, without the law of what is inside them. Brier scores after isotonic calibration on
the tuning grounds, for each sensor and method; *the share alone* is who always says the share of impassable cells of that D.)");
  for (const SensorResults& r : campaign()) {
    print_text("\n### Impassable cells, " + r.sensor);
    print_text(
        fmt::format("\nTuned: relief within {} m; plane of {} m with {} rad, step in {} m with {} m, roughness in {} m "
                    "with {} m, weights {} : {} : {}.\n\nArea under the ROC, all cells:",
                    r.rules.relief_radius_m, r.rules.plane.slope_radius_m, r.rules.plane.slope_critical_rad,
                    r.rules.plane.step_radius_m, r.rules.plane.step_critical_m, r.rules.plane.roughness_radius_m,
                    r.rules.plane.roughness_critical_m, r.rules.plane.slope_weight, r.rules.plane.step_weight,
                    r.rules.plane.roughness_weight));
    auc_table(r, kAllCells);
    print_text("\nArea under the ROC, reconstructed cells:");
    auc_table(r, kReconstructedCells);
    verdict(r, kAllCells, kCost, "Cost, all cells");
    verdict(r, kAllCells, kRisk, "Risk, all cells");
    verdict(r, kReconstructedCells, kCost, "Cost, reconstructed cells");
    verdict(r, kReconstructedCells, kRisk, "Risk, reconstructed cells");
    print_text("\nBrier score, all cells:");
    brier_table(r);
  }
}

}  // namespace scree::bench
