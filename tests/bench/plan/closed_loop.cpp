#include "tests/bench/plan/closed_loop.hpp"

#include <cmath>
#include <fmt/format.h>

#include "drivers/driven_robot.hpp"
#include "node/robot_way.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {
namespace {

using scree_example::Path;
using scree_example::Point;
using scree_example::Posture;

constexpr Duration kCommandPeriod = std::chrono::milliseconds(50);
constexpr int kPatience = 10;  // frames
constexpr double kMargin_m = 5.0;

drivers::SimulatorConfig simulator_config(const GroundFile& file, const Mission& mission) {
  drivers::SimulatorConfig config = drive_config(file, "lidar64", mission.spec.seed);
  const double heading_deg =
      std::atan2(mission.goal.y_m - mission.start.y_m, mission.goal.x_m - mission.start.x_m) * 180.0 / std::numbers::pi;
  config.trajectory = fmt::format("line:{},{},{},0,1", mission.start.x_m, mission.start.y_m, heading_deg);
  config.frame_period = from_seconds(kFrame_s);
  return config;
}

Posture posture_of(const Pose& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return {{pose.translation_m.x(), pose.translation_m.y()}, std::atan2(ahead.y(), ahead.x())};
}

/// The frame where the robot was driven: the simulator only knows where the trajectory begins.
RangeFrame with_poses(const RangeFrame& frame, const PoseTrack& track) {
  RangeFrame out = frame;
  for (std::size_t row = 0; row < out.row_time.size(); ++row) out.T_map_body[row] = *track.at(out.row_time[row]);
  return out;
}

class Loop {
 public:
  Loop(const Mission& mission, const drivers::Simulator& simulator, CostMaker& costs)
      : mission_(mission),
        simulator_(simulator),
        costs_(costs),
        robot_(must(drivers::DrivenRobot::make(simulator.terrain(), place(simulator), {}, {}, 1))),
        way_(node::as_driven(simulator, robot_)),
        limits_(simulator.terrain(), {}),
        at_m_(robot_.truth().back().T_map_body.translation_m) {}

  Outcome run() {
    for (std::size_t i = 0; !done_; ++i) {
      drive_until(simulator_.last_row_time(i));
      if (!done_) look(i);
    }
    outcome_.duration_s = to_seconds(now_ - simulator_.frame_time(0));
    outcome_.path_m = path_m_;
    outcome_.violated_m = limits_.violated_m();
    outcome_.unjudged = limits_.without_ground();
    return outcome_;
  }

 private:
  static drivers::PlanarPose place(const drivers::Simulator& simulator) {
    const Pose start = *simulator.poses().at(simulator.frame_time(0));
    const Posture posture = posture_of(start);
    return {simulator.frame_time(0), posture.at.x_m, posture.at.y_m, posture.heading_rad};
  }

  void drive_until(Time end) {
    while (now_ < end && !done_) {
      const Pose& pose = robot_.truth().back().T_map_body;
      const Posture posture = posture_of(pose);
      path_m_ += (pose.translation_m - at_m_).norm();
      at_m_ = pose.translation_m;
      if (scree_example::distance_m(posture.at, mission_.start) > kBlind_m) limits_.add(pose);
      outcome_.arrived = scree_example::distance_m(posture.at, mission_.goal) <= follow_.goal_radius_m;
      done_ = outcome_.arrived || to_seconds(now_ - simulator_.frame_time(0)) > kLimit_s;
      const auto drive = path_.found ? scree_example::follow(path_, posture, follow_) : scree_example::Drive{};
      robot_.command(drive.speed_mps, drive.curvature_per_m, now_);
      now_ = std::min(now_ + kCommandPeriod, end);
      robot_.advance_to(now_);
    }
  }

  void look(std::size_t i) {
    robot_.advance_to(simulator_.last_row_time(i) + drivers::DrivenRobot::kPosePeriod);
    const auto track = must(
        PoseTrack::make(node::poses_around(robot_.truth(), simulator_.frame_time(i), simulator_.last_row_time(i))));
    const auto rendered = must(way_->render(i, serial_));
    costs_.add(with_poses(*simulator_.range_frame(rendered, Duration{0}), track));
    const Posture posture = posture_of(robot_.truth().back().T_map_body);
    scree_example::cut_to_box(costs_.costs(), posture.at, mission_.goal, kMargin_m, grid_);
    path_ = planner_.plan(grid_, posture.at, mission_.goal);
    without_path_ = path_.found ? 0 : without_path_ + 1;
    outcome_.plans_without_path += path_.found ? 0 : 1;
    done_ = without_path_ >= kPatience;
  }

  const Mission& mission_;
  const drivers::Simulator& simulator_;
  CostMaker& costs_;
  SerialExecutor serial_;
  drivers::DrivenRobot robot_;
  std::unique_ptr<node::RobotWay> way_;
  node::GroundLimits limits_;
  Eigen::Vector3d at_m_;
  double path_m_ = 0.0;
  scree_example::PathPlanner planner_;
  scree_example::FollowRules follow_;
  scree_example::CostGrid grid_;
  Path path_;
  Time now_ = simulator_.frame_time(0);
  Outcome outcome_;
  int without_path_ = 0;
  bool done_ = false;
};

}  // namespace

Outcome drive(const Mission& mission, const GroundFile& ground, Rival rival, const BaselineTuning& tuning) {
  const auto simulator = must(drivers::Simulator::make(simulator_config(ground, mission)));
  const auto costs = make_costs(rival, tuning);
  return Loop(mission, simulator, *costs).run();
}

}  // namespace scree::bench
