// The point of it all: how well cost and risk tell the cells that the true ground makes impassable.

#include <span>

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"

namespace scree::bench {
namespace {

using Scenes = std::vector<const Judgement*>;

Scenes scenes_of(const std::vector<Judgement>& all, double dimension) {
  Scenes out;
  for (const Judgement& j : all)
    if (dimension == 0.0 || j.dimension == dimension) out.push_back(&j);
  return out;
}

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

void auc_row(const std::string& name, const Scenes& scenes, CellClass kind) {
  double cells = 0.0, bad = 0.0;
  const ScoreCounts counts = pooled(scenes, kind, kCost);
  cells = counts.cells(), bad = counts.share_impassable();
  const bool risk = pooled(scenes, kind, kRisk).cells() > 0.0;
  const Method ours = risk ? kRisk : kCost;
  print_text(fmt::format("| {} | {:.0f} | {:.0f} % | {} | {} | {} | {} | {} | {} | {} |", name, cells, 100.0 * bad,
                         number(auc(scenes, kind, kCost)), number(auc(scenes, kind, kRisk)),
                         number(auc(scenes, kind, kRelief)), number(auc(scenes, kind, kPlane)),
                         number(auc(scenes, kind, kFootprint)), signed_interval_text(gain(scenes, kind, ours, kRelief)),
                         signed_interval_text(gain(scenes, kind, ours, kPlane))));
}

void auc_table(const SensorResults& r, CellClass kind) {
  print_text(
      "\n| D | cells | impassable | cost | risk | smooth fill, relief | slope, step, roughness | smooth fill, "
      "footprint | ours less relief (95 %) | ours less slope, step, roughness (95 %) |\n"
      "|---|---|---|---|---|---|---|---|---|---|");
  for (const double d : kDimensions)
    if (const Scenes scenes = scenes_of(r.scenes, d); !scenes.empty()) auc_row(fixed(d, 1), scenes, kind);
  auc_row("all", scenes_of(r.scenes, 0.0), kind);
}

}  // namespace

void separation_section() {
  print_text("\n## Impassable cells");
  for (const SensorResults& r : campaign()) {
    print_text("\n### " + r.sensor);
    print_text(
        fmt::format("\nTuned baselines: relief within {} m; slope of the plane in {} m / {} rad, step in {} m / {} m, "
                    "roughness in {} m / {} m, weights {} : {} : {}.\n",
                    r.rules.relief_radius_m, r.rules.plane.slope_radius_m, r.rules.plane.slope_critical_rad,
                    r.rules.plane.step_radius_m, r.rules.plane.step_critical_m, r.rules.plane.roughness_radius_m,
                    r.rules.plane.roughness_critical_m, r.rules.plane.slope_weight, r.rules.plane.step_weight,
                    r.rules.plane.roughness_weight));
    print_text("All cells with a cost:");
    auc_table(r, kAllCells);
    print_text("\nReconstructed cells alone:");
    auc_table(r, kReconstructedCells);
  }
}

}  // namespace scree::bench
