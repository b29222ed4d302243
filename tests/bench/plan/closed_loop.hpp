#pragma once
// Simulator, map, planner and robot in one loop, in simulated time: what the sockets carry otherwise.

#include "node/ground_limits.hpp"
#include "tests/bench/plan/cost_maker.hpp"

namespace scree::bench {

struct Mission {
  GroundSpec spec;
  scree_example::Point start{-6.0, -6.0}, goal{5.5, 6.0};
};

struct Outcome {
  bool arrived = false;
  double duration_s = 0.0, path_m = 0.0;
  double violated_m = 0.0;  ///< of the path, on the true ground, where a limit of the vehicle was exceeded
  int plans_without_path = 0;
};

/// A lidar of 64 rows every kFrame_s, a plan for every map, a command every 50 ms; exact poses. Ends at the goal, after
/// kLimit_s, or when there was no path for ten frames.
Outcome drive(const Mission& mission, Rival rival, const BaselineTuning& tuning);
inline constexpr double kFrame_s = 0.7, kLimit_s = 90.0;

}  // namespace scree::bench
