#pragma once
// The one scene that a test can afford: a few frames of the small scanner, judged before the robot.

#include "tests/bench/map/truth/judge.hpp"

namespace scree::bench {

/// D 2.4, 0.06 m rms over 0.3 m, rocks and ditch; perceptron-cmu, six frames over 3 m; cells of 8 × 8 m judged, the
/// baselines with the rules that the bench mostly finds best. Cost: some two seconds.
Judgement judge_small_scene(std::uint64_t seed);

}  // namespace scree::bench
