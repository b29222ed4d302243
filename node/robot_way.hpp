#pragma once
// Where a simulated robot is, as time goes on: along a trajectory that is known, or as it is driven.

#include <memory>
#include <optional>
#include <vector>

#include "core/result.hpp"
#include "drivers/driven_robot.hpp"
#include "drivers/simulator.hpp"

namespace scree::node {

class RobotWay {
 public:
  virtual ~RobotWay() = default;
  virtual void advance_to(Time time) = 0;
  /// Poses up to now at least, in time, as far back as a frame needs them.
  virtual const std::vector<StampedPose>& truth() const = 0;
  virtual const std::vector<StampedPose>& odometry() const = 0;
  /// Whether frame i can be rendered: its last row lies in the past of the robot.
  virtual bool can_render(std::size_t i) const = 0;
  virtual Result<drivers::SimulatedFrame> render(std::size_t i, Executor& executor) const = 0;
  /// How many frames there are, where the way has an end.
  virtual std::optional<std::size_t> frame_count() const = 0;
};

std::unique_ptr<RobotWay> along_trajectory(const drivers::Simulator& simulator);
/// `robot` is shared with who commands it.
std::unique_ptr<RobotWay> as_driven(const drivers::Simulator& simulator, drivers::DrivenRobot& robot);

/// The poses of `track` from the last one at or before `begin` to the first one at or after `end`.
std::vector<StampedPose> poses_around(const std::vector<StampedPose>& track, Time begin, Time end);

}  // namespace scree::node
