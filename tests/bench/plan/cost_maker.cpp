#include "tests/bench/plan/cost_maker.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/distance.hpp"
#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/truth/scene_truth.hpp"
#include "tests/bench/map/tuning.hpp"

namespace scree::bench {
namespace {

using scree_example::CostGrid;

constexpr int kWindow = 200;  // the mapper's default
constexpr double kReach_cells = 6.0;

CostGrid grid_of(const LatticeWindow& window) {
  CostGrid out;
  out.columns = window.columns;
  out.rows = window.rows;
  out.cell_m = kMapCell_m;
  out.x_min_m = window.min.x * kMapCell_m;
  out.y_min_m = window.min.y * kMapCell_m;
  out.cost.assign(static_cast<std::size_t>(window.rows) * static_cast<std::size_t>(window.columns),
                  scree_example::kUnknown);
  return out;
}

class ScreeCosts final : public CostMaker {
 public:
  void add(const RangeFrame& frame) override { must(mapper_.step(frame)); }
  CostGrid costs() override {
    const auto map = mapper_.snapshot();
    CostGrid out = grid_of(map->window);
    std::copy(map->cost.begin(), map->cost.end(), out.cost.begin());
    return out;
  }

 private:
  SerialExecutor serial_;
  mapping::Mapper mapper_{{}, serial_};
};

/// Ground that no return fell on and that does not lie between returns is as unknown to them as to Scree; everywhere
/// else the cost is 252 times the calibrated probability of impassable ground, lethal from Scree's own limit on.
class BaselineCosts final : public CostMaker {
 public:
  BaselineCosts(Rival rival, const BaselineTuning& tuning) : rival_(rival), tuning_(tuning) {}

  void add(const RangeFrame& frame) override {
    plain_.add(frame);
    const Eigen::Vector3d& at = frame.T_map_body.back().translation_m;
    const CellIndex body = lattice_cell(at.x(), at.y(), kMapCell_m);
    window_ = {{body.x - kWindow / 2, body.y - kWindow / 2}, kWindow, kWindow};
  }

  CostGrid costs() override {
    const WelfordMap map = plain_.cut(window_);
    const Grid<float> filled = smooth_fill(map.mean_m);
    const Grid<float> score = rival_ == Rival::relief
                                  ? relief_score(relief(filled, kMapCell_m, tuning_.rules.relief_radius_m))
                                  : plane_hazard(filled, kMapCell_m, tuning_.rules.plane);
    const Calibration& calibration = rival_ == Rival::relief ? tuning_.relief : tuning_.plane;
    const Grid<std::uint8_t> known = between_returns(map);
    CostGrid out = grid_of(window_);
    for (std::size_t i = 0; i < known.size(); ++i)
      if (known[i] != 0 && !std::isnan(score[i])) out.cost[i] = cost_of(calibration, score[i]);
    return out;
  }

 private:
  Grid<std::uint8_t> between_returns(const WelfordMap& map) {
    Grid<std::uint8_t> hit(map.hits.rows(), map.hits.columns(), 0), closed;
    for (std::size_t i = 0; i < hit.size(); ++i) hit[i] = map.hits[i] > 0 ? 1 : 0;
    closing_.close(hit, kReach_cells, serial_, closed);
    return closed;
  }
  static std::uint8_t cost_of(const Calibration& calibration, float score) {
    const int bin = std::clamp(static_cast<int>(score * kScoreBins), 0, kScoreBins - 1);
    const double probability = calibration[static_cast<std::size_t>(bin)];
    if (probability >= mapping::CostConfig{}.lethal_risk) return scree_example::kLethal;
    return static_cast<std::uint8_t>(std::lround(252.0 * probability));
  }

  Rival rival_;
  BaselineTuning tuning_;
  SerialExecutor serial_;
  mapping::Closing closing_;
  WelfordFusion plain_{kMapCell_m, kWindow};
  LatticeWindow window_;
};

struct Tried {
  GroundSpec spec;
  std::shared_ptr<const SceneTruth> truth;
  DrivenMaps maps;
};

Tried try_ground(const GroundSpec& spec) {
  const Ground ground = must(make_ground(spec));
  const GroundFile file(ground);
  const auto simulator = simulator_over(file, "lidar64", spec.seed);
  const auto maps = map_drive(render_all(simulator), {});
  return {spec, std::make_shared<SceneTruth>(scene_truth(ground, {}, maps.map->window)), maps};
}

}  // namespace

BaselineTuning tune_baselines() {
  std::vector<GroundSpec> specs;
  for (const double dimension : {2.2, 2.4, 2.6})
    for (const std::uint64_t seed : {901U, 902U}) specs.push_back({dimension, 0.05, seed});
  const auto tried = over_surfaces(static_cast<int>(specs.size()), [&](int i) {
    return std::make_shared<Tried>(try_ground(specs[static_cast<std::size_t>(i)]));
  });
  std::vector<TuningMap> maps;
  for (const auto& one : tried) maps.push_back({one->spec, one->truth, one->maps.map, one->maps.plain});
  BaselineTuning out;
  out.rules = tuned_rules(maps);
  ScoreCounts relief, plane;
  for (const auto& one : tried) {
    const Judgement scene = judge({one->spec, *one->truth, *one->maps.map, one->maps.plain, out.rules, nullptr, {}});
    relief += scene.scores[kAllCells][kRelief];
    plane += scene.scores[kAllCells][kPlane];
  }
  out.relief = isotonic(relief);
  out.plane = isotonic(plane);
  return out;
}

std::unique_ptr<CostMaker> make_costs(Rival rival, const BaselineTuning& tuning) {
  if (rival == Rival::scree) return std::make_unique<ScreeCosts>();
  return std::make_unique<BaselineCosts>(rival, tuning);
}

}  // namespace scree::bench
