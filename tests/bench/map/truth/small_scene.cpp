#include "tests/bench/map/truth/small_scene.hpp"

#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {

Judgement judge_small_scene(std::uint64_t seed) {
  const GroundSpec spec{2.4, 0.065, seed};
  const Ground ground = must(make_ground(spec));
  const SceneTruth truth = scene_truth(ground, {}, LatticeWindow{{-25, -60}, 120, 120});
  const GroundFile file(ground);
  drivers::SimulatorConfig config = drive_config(file, "lidar64", seed);
  config.trajectory = "line:1.7,0,0,1.8,1";
  const auto simulator = must(drivers::Simulator::make(config));
  const DrivenMaps maps = map_drive(render_all(simulator), {});
  BaselineRules rules;
  rules.relief_radius_m = 0.5;
  rules.plane = {0.5, 0.15, 0.5, 1.0, 0.3, 0.05, 0.0, 1.0, 1.0};
  const Sight sight(simulator);
  return judge({spec, truth, *maps.map, maps.plain, rules, &sight, {}});
}

}  // namespace scree::bench
