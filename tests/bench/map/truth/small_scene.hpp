#pragma once
// The one scene that a test can afford: a few frames of the lidar, judged around the robot.

#include "tests/bench/map/truth/judge.hpp"

namespace scree::bench {

/// D 2.4, 0.065 m rms over 0.3 m, rocks and ditch; lidar64, four frames over 1.8 m; cells of 12 × 12 m about the robot
/// judged, the baselines with the rules that the bench finds best for this sensor. Cost: some three seconds.
Judgement judge_small_scene(std::uint64_t seed);

}  // namespace scree::bench
