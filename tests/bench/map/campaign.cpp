#include "tests/bench/map/campaign.hpp"

#include <memory>

#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/tuning.hpp"

namespace scree::bench {
namespace {

std::vector<GroundSpec> grounds(std::uint64_t first_seed, int of_each) {
  std::vector<GroundSpec> out;
  std::uint64_t number = 0;
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const double relief_m : kReliefs_m)
      for (int seed = 0; seed < of_each; ++seed, ++number)
        if (!quick || (d % 3 == 1 && relief_m == kReliefs_m.back()))
          out.push_back({kDimensions[d], relief_m, first_seed + number});
  return out;
}

/// What is the same for all sensors of a ground.
struct Place {
  Place(const GroundSpec& ground_spec, const Ground& ground)
      : spec(ground_spec), truth(std::make_shared<const SceneTruth>(scene_truth(ground, {}))), file(ground) {}
  explicit Place(const GroundSpec& ground_spec) : Place(ground_spec, must(make_ground(ground_spec))) {}
  GroundSpec spec;
  std::shared_ptr<const SceneTruth> truth;
  GroundFile file;
};

std::vector<std::vector<TuningMap>> tuning_maps() {
  const auto specs = grounds(kTuningSeed, 1);
  const auto by_ground = over_surfaces(static_cast<int>(specs.size()), [&](int i) {
    const Place place(specs[static_cast<std::size_t>(i)]);
    std::vector<TuningMap> out;
    for (const char* sensor : kSensors) {
      const auto simulator = simulator_over(place.file, sensor, place.spec.seed);
      DrivenMaps maps = map_drive(render_all(simulator), {});
      out.push_back({place.spec, place.truth, maps.map, std::move(maps.plain)});
    }
    return out;
  });
  std::vector<std::vector<TuningMap>> by_sensor(kSensors.size());
  for (const auto& ground : by_ground)
    for (std::size_t s = 0; s < ground.size(); ++s) by_sensor[s].push_back(ground[s]);
  return by_sensor;
}

SensorResults prepared(const std::string& sensor, const std::vector<TuningMap>& maps) {
  SensorResults out{sensor, tuned_rules(maps), {}, {}};
  const auto judged = over_surfaces(static_cast<int>(maps.size()), [&](int i) {
    const TuningMap& m = maps[static_cast<std::size_t>(i)];
    return judge({m.spec, *m.truth, *m.map, m.plain, out.rules, nullptr, {}}).scores[kAllCells];
  });
  std::array<ScoreCounts, kMethods> sums;
  for (const auto& counts : judged)
    for (std::size_t m = 0; m < sums.size(); ++m) sums[m] += counts[m];
  for (std::size_t m = 0; m < sums.size(); ++m) out.calibration[m] = isotonic(sums[m]);
  return out;
}

std::vector<SensorResults> run() {
  std::vector<SensorResults> results;
  const auto maps = tuning_maps();
  for (std::size_t s = 0; s < kSensors.size(); ++s) results.push_back(prepared(kSensors[s], maps[s]));
  std::fprintf(stderr, "map_accuracy: baselines tuned\n");
  const auto specs = grounds(kFirstSeed, quick ? 1 : seeds);
  const auto by_ground = over_surfaces(static_cast<int>(specs.size()), [&](int i) {
    const Place place(specs[static_cast<std::size_t>(i)]);
    std::vector<Judgement> out;
    for (const SensorResults& r : results) {
      const auto simulator = simulator_over(place.file, r.sensor, place.spec.seed);
      const DrivenMaps maps_now = map_drive(render_all(simulator), {});
      const Sight sight(simulator);
      out.push_back(judge({place.spec, *place.truth, *maps_now.map, maps_now.plain, r.rules, &sight, {}}));
    }
    return out;
  });
  for (const auto& ground : by_ground)
    for (std::size_t s = 0; s < results.size(); ++s) results[s].scenes.push_back(ground[s]);
  return results;
}

}  // namespace

const std::vector<SensorResults>& campaign() {
  static const std::vector<SensorResults> results = run();
  return results;
}

Scenes scenes_of(const std::vector<Judgement>& all, double dimension) {
  Scenes out;
  for (const Judgement& j : all)
    if (dimension == 0.0 || j.dimension == dimension) out.push_back(&j);
  return out;
}

}  // namespace scree::bench
