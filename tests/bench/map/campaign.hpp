#pragma once
// All drives of the report, made once: the baselines tuned and everything calibrated on some grounds, judged on others.

#include <array>
#include <string>
#include <vector>

#include "tests/bench/map/truth/judge.hpp"

namespace scree::bench {

inline constexpr std::array<const char*, 4> kSensors = {"perceptron-usf", "perceptron-cmu", "lidar64", "depth"};
inline constexpr std::array kDimensions = {2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
/// rms height change over 0.3 m: ground whose own relief seldom stops the vehicle, and ground whose often does.
inline constexpr std::array kReliefs_m = {0.05, 0.065};
inline constexpr std::uint64_t kTuningSeed = 100, kFirstSeed = 200;

struct SensorResults {
  std::string sensor;
  BaselineRules rules;                            ///< tuned for this sensor
  std::array<Calibration, kMethods> calibration;  ///< of all cells, for this sensor
  std::vector<Judgement> scenes;
};

/// A drive of each sensor over each ground of kDimensions × kReliefs_m × seeds (quick: every third D, the rougher
/// ground, one seed). Some twelve minutes on two cores the first time it is asked for.
const std::vector<SensorResults>& campaign();

/// Of one D; 0 = of all.
using Scenes = std::vector<const Judgement*>;
Scenes scenes_of(const std::vector<Judgement>& all, double dimension = 0.0);

/// Sum of a member over scenes.
template <class Sums>
Sums total(const Scenes& scenes, Sums Judgement::*member) {
  Sums sum;
  for (const Judgement* scene : scenes) sum += scene->*member;
  return sum;
}

}  // namespace scree::bench
