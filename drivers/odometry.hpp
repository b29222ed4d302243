#pragma once
// Poses as odometry and an inertial unit would have them: the true way with errors that grow and wander.

#include <cstdint>
#include <memory>

#include "drivers/frame/pose_track.hpp"

namespace scree::drivers {

/// How wrong the poses of a simulated drive are. Zero = exact.
struct OdometryErrors {
  double drift_share = 0.0;       ///< of the way: rms error of the position along, across and up, each
  double attitude_rms_rad = 0.0;  ///< rms error about each of the map's axes

  bool any() const { return drift_share > 0.0 || attitude_rms_rad > 0.0; }
};

/// The errors of a drive as it comes: what odometry_track gives for the same poses.
class Odometry {
 public:
  Odometry(const OdometryErrors& errors, std::uint64_t seed);
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;
  ~Odometry();

  /// Where odometry says that the robot is when it is at `truth`; times increase, poses at most 0.1 s apart.
  Pose advance(Time time, const Pose& truth);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// `truth` with errors, at the same times and at most 0.1 s apart, so that what lies between them is linear enough.
/// Position: exact at the first pose; per metre of way the odometry errs along, across and up (body's heading) by rates
/// whose variance is half a constant of the drive, half a stationary walk that is forgotten over 5 m of way. The rms
/// over seeds is drift_share · way at first and still 0.8 of that after 20 m. A robot that stands does not drift.
/// Attitude: a rotation in map axes whose components are sums of four sines of time, periods 8 … 40 s, rms over seeds
/// attitude_rms_rad at every time, the first included.
/// A function of (truth, errors, seed) alone. `truth` must not be PoseTrack::fixed. O(duration).
PoseTrack odometry_track(const PoseTrack& truth, const OdometryErrors& errors, std::uint64_t seed);

}  // namespace scree::drivers
