// The same drives when odometry drifts and the attitude errs: drift must not read as roughness nor as walls.

#include <array>
#include <numbers>

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"
#include "tests/bench/map/quantiles.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {
namespace {

struct Error {
  const char* name;
  drivers::OdometryErrors odometry;
};
constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr std::array kErrors = {Error{"none", {}}, Error{"drift 1 %", {0.01, 0.0}}, Error{"drift 3 %", {0.03, 0.0}},
                                Error{"attitude 1°", {0.0, kDegree_rad}},
                                Error{"drift 3 %, attitude 1°", {0.03, kDegree_rad}}};
constexpr std::array<const char*, 2> kDriftSensors = {"perceptron-cmu", "lidar64"};
constexpr std::array kDriftDimensions = {2.2, 2.4, 2.6, 2.8};
constexpr std::uint64_t kDriftSeed = 300;
constexpr double kBiasTarget = 0.03;

drivers::Simulator simulator_with(const GroundFile& ground, const char* sensor, std::uint64_t seed,
                                  const drivers::OdometryErrors& odometry) {
  drivers::SimulatorConfig config = drive_config(ground, sensor, seed);
  config.odometry = odometry;
  return must(drivers::Simulator::make(config));
}

/// Where the map's places really are, as the robot at the end of the drive has them before it.
Pose true_from_map(const drivers::Simulator& simulator, Time end) {
  const auto at_end = [end](const PoseTrack& track) { return track.at(end).value_or(track.poses().back().T_map_body); };
  return at_end(simulator.poses()) * at_end(simulator.odometry()).inverse();
}

using Variants = std::array<Judgement, kErrors.size()>;

/// One ground, one sensor: rays leave the true poses, so the frames of all variants are one rendering.
Variants judge_variants(const GroundSpec& spec, const SceneTruth& truth, const GroundFile& file, const char* sensor) {
  Variants out;
  SerialExecutor serial;
  std::vector<drivers::SimulatedFrame> rendered;
  for (std::size_t v = 0; v < kErrors.size(); ++v) {
    const auto simulator = simulator_with(file, sensor, spec.seed, kErrors[v].odometry);
    if (rendered.empty())
      for (std::size_t i = 0; i < simulator.frame_count(); ++i) rendered.push_back(must(simulator.render(i, serial)));
    std::vector<std::shared_ptr<const RangeFrame>> frames;
    for (const auto& frame : rendered) frames.push_back(simulator.range_frame(frame, Duration{0}));
    const DrivenMaps maps = map_drive(frames, {});
    out[v] = judge(
        {spec, truth, *maps.map, maps.plain, {}, nullptr, true_from_map(simulator, frames.back()->row_time.back())});
  }
  return out;
}

using BySensor = std::array<Variants, kDriftSensors.size()>;

std::vector<BySensor> drives() {
  std::vector<GroundSpec> specs;
  for (const double d : kDriftDimensions)
    for (const double relief_m : kReliefs_m) specs.push_back({d, relief_m, kDriftSeed + specs.size()});
  if (quick) specs.resize(2);
  return over_surfaces(static_cast<int>(specs.size()), [&](int i) {
    const GroundSpec& spec = specs[static_cast<std::size_t>(i)];
    const Ground ground = must(make_ground(spec));
    const SceneTruth truth = scene_truth(ground, {});
    const GroundFile file(ground);
    BySensor out;
    for (std::size_t s = 0; s < out.size(); ++s) out[s] = judge_variants(spec, truth, file, kDriftSensors[s]);
    return out;
  });
}

struct Line {
  double bias, worst_bias, flagged, rmse_mm, coverage, false_lethal, false_near, auc;
};

Line line_of(const std::vector<BySensor>& all, std::size_t sensor, std::size_t variant) {
  Scenes scenes, exact;
  double false_lethal = 0, clear = 0, false_near = 0, clear_near = 0, worst = 0;
  for (const BySensor& by_sensor : all) {
    const Judgement& j = by_sensor[sensor][variant];
    scenes.push_back(&j), exact.push_back(&by_sensor[sensor][0]);
    false_lethal += j.false_lethal, clear += j.clear;
    false_near += j.false_lethal_near, clear_near += j.clear_near;
    const double bias = quantile(j.roughness.errors, 0.5) - quantile(exact.back()->roughness.errors, 0.5);
    if (std::abs(bias) > std::abs(worst)) worst = bias;
  }
  const DimensionScores d = total(scenes, &Judgement::roughness), d0 = total(exact, &Judgement::roughness);
  const HeightScores h = total(scenes, &Judgement::heights);
  ScoreCounts counts;
  for (const Judgement* j : scenes) counts += j->scores[kAllCells][kCost];
  return {quantile(d.errors, 0.5) - quantile(d0.errors, 0.5),
          worst,
          d.flagged / (d.flagged + static_cast<double>(d.errors.size())),
          1e3 * h.measured.rmse(),
          h.measured.coverage(),
          false_lethal / clear,
          false_near / clear_near,
          counts.auc()};
}

}  // namespace

void drift_section() {
  print_text(R"(
## Drift

The same frames with the poses that odometry would have had (docs/simulator.md). The map is judged as the robot at the end
of its drive has it before it: the truth under a cell is where the last pose puts it. Bias of D: median less that of exact
poses, over all grounds and on the worst one. *Lethal, but clear* as above.)");
  const std::vector<BySensor> all = drives();
  for (std::size_t s = 0; s < kDriftSensors.size(); ++s) {
    print_text(fmt::format("\n### Drift, {}\n", kDriftSensors[s]));
    print_text(
        "| poses | bias of D | worst ground | flagged | measured rmse (mm) | coverage | lethal, but clear | near the "
        "way "
        "| area under ROC of cost |\n|---|---|---|---|---|---|---|---|---|");
    std::string verdicts;
    for (std::size_t v = 0; v < kErrors.size(); ++v) {
      const Line line = line_of(all, s, v);
      print_text(fmt::format("| {} | {:+.3f} | {:+.3f} | {:.1f} % | {:.1f} | {:.3f} | {:.2f} % | {:.2f} % | {:.3f} |",
                             kErrors[v].name, line.bias, line.worst_bias, 100.0 * line.flagged, line.rmse_mm,
                             line.coverage, 100.0 * line.false_lethal, 100.0 * line.false_near, line.auc));
      if (v > 0)
        verdicts += fmt::format("{}{} {}", verdicts.empty() ? "" : "; ", kErrors[v].name,
                                within(std::abs(line.bias), 0.0, kBiasTarget));
    }
    print_text("\n|Bias of D| below .03: " + verdicts + ".");
  }
}

}  // namespace scree::bench
