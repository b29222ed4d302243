#pragma once
// A simulated robot that is driven: a unicycle on the terrain.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/result.hpp"
#include "drivers/odometry.hpp"
#include "drivers/terrain.hpp"
#include "drivers/trajectory.hpp"

namespace scree::drivers {

/// A command holds this long; then the robot stops.
inline constexpr Duration kDriveTimeout = std::chrono::milliseconds(500);

class DrivenRobot {
 public:
  static constexpr Duration kPosePeriod = std::chrono::milliseconds(10);
  /// Poses that are kept: the scan of any simulated sensor and more.
  static constexpr std::size_t kKeptPoses = 1024;

  /// Stands at `start`; `terrain` outlives the robot. Errors: usage (no ground there).
  static Result<DrivenRobot> make(const Terrain& terrain, const PlanarPose& start, const TrajectoryConfig& config,
                                  const OdometryErrors& errors, std::uint64_t seed);

  /// From `time` on, for kDriveTimeout. Positive curvature turns left; at speed 0 the robot does not turn.
  void command(double speed_mps, double curvature_per_m, Time time);
  /// Moves in steps of kPosePeriod, exact for a constant command, up to the last one at or before `time`. Where half of
  /// the footprint would leave the ground the robot stands still instead.
  void advance_to(Time time);

  /// The newest kKeptPoses or more, in time; where it was, and where its odometry says so.
  const std::vector<StampedPose>& truth() const { return truth_; }
  const std::vector<StampedPose>& odometry() const { return odometry_poses_; }
  std::uint64_t edge_stops() const { return edge_stops_; }  ///< times that the edge of the terrain stopped it
  std::uint64_t timeouts() const { return timeouts_; }      ///< times that a command ran out while it moved

 private:
  DrivenRobot(const Terrain& terrain, const PlanarPose& place, const TrajectoryConfig& config, Odometry odometry)
      : terrain_(&terrain), place_(place), config_(config), odometry_(std::move(odometry)) {}
  void step();
  void keep(const Pose& pose);

  const Terrain* terrain_;
  PlanarPose place_;
  TrajectoryConfig config_;
  Odometry odometry_;
  std::vector<StampedPose> truth_, odometry_poses_;
  double speed_mps_ = 0.0, curvature_per_m_ = 0.0;
  Time command_ends_;
  bool at_edge_ = false;
  std::uint64_t edge_stops_ = 0, timeouts_ = 0;
};

/// Where a unicycle comes from `place` on a way of this (signed) length at this curvature.
PlanarPose along_arc(const PlanarPose& place, double way_m, double curvature_per_m);

}  // namespace scree::drivers
