#include "tests/bench/map/tuning.hpp"

#include <array>
#include <cmath>
#include <functional>

#include "tests/bench/map/report.hpp"

namespace scree::bench {
namespace {

constexpr std::array kRadii_m = {0.15, 0.2, 0.3, 0.4, 0.5};

struct Filled {
  Grid<float> height_m;
  Grid<std::int8_t> impassable;  ///< −1: not judged
};

Filled fill(const TuningMap& in) {
  Filled out{smooth_fill(in.plain.mean_m), Grid<std::int8_t>(in.map->cost.rows(), in.map->cost.columns(), -1)};
  for (int row = 0; row < out.impassable.rows(); ++row)
    for (int column = 0; column < out.impassable.columns(); ++column) {
      const int r = row + in.map->window.min.y - in.truth->cells.min.y;
      const int c = column + in.map->window.min.x - in.truth->cells.min.x;
      if (in.map->cost(row, column) == mapping::kCostUnknown || !in.truth->worst_share.contains(r, c)) continue;
      if (!std::isnan(in.truth->worst_share(r, c))) out.impassable(row, column) = in.truth->impassable(r, c) ? 1 : 0;
    }
  return out;
}

using Hazard = std::function<Grid<float>(const Grid<float>&)>;  // values in 0 … 1

double auc(const std::vector<Filled>& maps, const Hazard& hazard) {
  const auto counts = over_surfaces(static_cast<int>(maps.size()), [&](int i) {
    const Filled& map = maps[static_cast<std::size_t>(i)];
    const Grid<float> values = hazard(map.height_m);
    ScoreCounts out;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (map.impassable[k] >= 0 && !std::isnan(values[k])) out.add(values[k], map.impassable[k] > 0);
    return out;
  });
  ScoreCounts all;
  for (const ScoreCounts& c : counts) all += c;
  return all.auc();
}

double tuned_relief_radius_m(const std::vector<Filled>& maps) {
  double best = 0.0, best_radius_m = kRadii_m[0];
  for (const double radius_m : kRadii_m) {
    const double area = auc(maps, [&](const Grid<float>& z) { return relief_score(relief(z, kMapCell_m, radius_m)); });
    if (area > best) best = area, best_radius_m = radius_m;
  }
  return best_radius_m;
}

PlaneRules tuned_plane(const std::vector<Filled>& maps) {
  struct Coordinate {
    double PlaneRules::*value;
    std::vector<double> choices;
  };
  const std::vector<double> radii(kRadii_m.begin(), kRadii_m.end()), weights = {0.0, 0.5, 1.0, 2.0};
  const std::array<Coordinate, 9> coordinates = {{{&PlaneRules::slope_radius_m, radii},
                                                  {&PlaneRules::step_radius_m, {0.1, 0.15, 0.2, 0.3}},
                                                  {&PlaneRules::roughness_radius_m, radii},
                                                  {&PlaneRules::slope_critical_rad, {0.4, 0.6, 1.0}},
                                                  {&PlaneRules::step_critical_m, {0.12, 0.2, 0.3, 0.5}},
                                                  {&PlaneRules::roughness_critical_m, {0.03, 0.05, 0.1, 0.2}},
                                                  {&PlaneRules::slope_weight, weights},
                                                  {&PlaneRules::step_weight, weights},
                                                  {&PlaneRules::roughness_weight, weights}}};
  PlaneRules best;
  const auto area = [&](const PlaneRules& rules) {
    if (rules.slope_weight + rules.step_weight + rules.roughness_weight == 0.0) return 0.0;
    return auc(maps, [&](const Grid<float>& z) { return plane_hazard(z, kMapCell_m, rules); });
  };
  double best_area = area(best);
  for (int round = 0; round < (quick ? 1 : 2); ++round)
    for (const auto& [value, choices] : coordinates)
      for (const double choice : choices) {
        PlaneRules trial = best;
        if (trial.*value == choice) continue;
        trial.*value = choice;
        const double trial_area = area(trial);
        if (trial_area > best_area) best_area = trial_area, best = trial;
      }
  return best;
}

}  // namespace

BaselineRules tuned_rules(const std::vector<TuningMap>& maps) {
  const auto filled =
      over_surfaces(static_cast<int>(maps.size()), [&](int i) { return fill(maps[static_cast<std::size_t>(i)]); });
  return {tuned_relief_radius_m(filled), tuned_plane(filled)};
}

}  // namespace scree::bench
