#include "drivers/driven_robot.hpp"

#include <cmath>
#include <utility>

namespace scree::drivers {

PlanarPose along_arc(const PlanarPose& place, double way_m, double curvature_per_m) {
  const double turn = curvature_per_m * way_m;
  // Chord of the arc: 2·sin(turn/2)/curvature, along the mean heading; sinc keeps the straight line exact.
  const double chord = turn == 0.0 ? way_m : way_m * std::sin(0.5 * turn) / (0.5 * turn);
  const double mean = place.heading_rad + 0.5 * turn;
  return {place.time, place.x_m + chord * std::cos(mean), place.y_m + chord * std::sin(mean), place.heading_rad + turn};
}

Result<DrivenRobot> DrivenRobot::make(const Terrain& terrain, const PlanarPose& start, const TrajectoryConfig& config,
                                      const OdometryErrors& errors, std::uint64_t seed) {
  const auto pose = place_on_terrain(start, terrain, config);
  if (!pose) return pose.error();
  DrivenRobot robot(terrain, start, config, Odometry(errors, seed));
  robot.command_ends_ = start.time;
  robot.truth_.reserve(2 * kKeptPoses);
  robot.odometry_poses_.reserve(2 * kKeptPoses);
  robot.keep(*pose);
  return robot;
}

void DrivenRobot::command(double speed_mps, double curvature_per_m, Time time) {
  speed_mps_ = speed_mps;
  curvature_per_m_ = curvature_per_m;
  command_ends_ = time + kDriveTimeout;
}

void DrivenRobot::advance_to(Time time) {
  while (place_.time + kPosePeriod <= time) step();
}

void DrivenRobot::step() {
  if (speed_mps_ != 0.0 && place_.time >= command_ends_) {
    speed_mps_ = 0.0;
    ++timeouts_;
  }
  Pose pose = truth_.back().T_map_body;
  PlanarPose next = along_arc(place_, speed_mps_ * to_seconds(kPosePeriod), curvature_per_m_);
  if (speed_mps_ != 0.0) {
    const auto placed = place_on_terrain(next, *terrain_, config_);
    if (placed)
      pose = *placed;
    else
      next = place_;
    if (!placed && !at_edge_) ++edge_stops_;
    at_edge_ = !placed;
  }
  next.time = place_.time + kPosePeriod;
  place_ = next;
  keep(pose);
}

void DrivenRobot::keep(const Pose& pose) {
  for (auto* poses : {&truth_, &odometry_poses_})
    if (poses->size() == 2 * kKeptPoses) poses->erase(poses->begin(), poses->begin() + kKeptPoses);
  truth_.push_back({place_.time, pose});
  odometry_poses_.push_back({place_.time, odometry_.advance(place_.time, pose)});
}

}  // namespace scree::drivers
