#pragma once
// Simulator, map, planner and robot in one loop, in simulated time: what the sockets carry otherwise.

#include "node/ground_limits.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/plan/cost_maker.hpp"

namespace scree::bench {

struct Mission {
  GroundSpec spec;
  scree_example::Point start{-4.5, -4.5}, goal{4.5, 4.5};
};

struct Outcome {
  bool arrived = false;
  double duration_s = 0.0, path_m = 0.0;
  double violated_m = 0.0;     ///< of the path, on the true ground, where a limit of the vehicle was exceeded
  std::uint64_t unjudged = 0;  ///< poses with a hole or the edge of the ground under the footprint
  int plans_without_path = 0;
};

/// A lidar of 64 rows every kFrame_s, a plan for every map, a command every 50 ms; exact poses. Ends at the goal, after
/// kLimit_s, or when there was no path for ten frames.
Outcome drive(const Mission& mission, const GroundFile& ground, Rival rival, const BaselineTuning& tuning);
/// What the lidar cannot see from the start, whatever its costs: not counted as beyond a limit.
inline constexpr double kBlind_m = 3.5;
inline constexpr double kFrame_s = 1.0, kLimit_s = 90.0;

}  // namespace scree::bench
