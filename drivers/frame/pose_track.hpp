#pragma once
// A time series of poses and its interpolation.

#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "core/result.hpp"
#include "core/time.hpp"

namespace scree {

struct StampedPose {
  Time time;
  Pose T_map_body;
};

/// Linear in translation, slerp in rotation; before.time ≤ time ≤ after.time, which differ.
Pose interpolate(const StampedPose& before, const StampedPose& after, Time time);

class PoseTrack {
 public:
  /// Two different poses farther apart in time say nothing of what lies between them. A robot that accelerates by
  /// 1 m/s² departs from the straight line between them by at most a·t²/8: one cell of the default map in 1 s.
  static constexpr Duration kMaxGap = std::chrono::seconds(1);

  /// Poses in strictly increasing time, finite, quaternions of norm 1 ± 1e-3 (they are normalised). Errors: bad_data
  /// that names the pose's index.
  static Result<PoseTrack> make(std::vector<StampedPose> poses);

  /// A body that never moves; finite and of a nonzero quaternion (normalised here). at() holds at every time.
  static PoseTrack fixed(const Pose& T_map_body);

  /// Linear in translation, slerp in rotation, a pose itself at its own time; nothing outside [begin, end] (a single
  /// pose is known at its own time only), and nothing inside a gap (gap_at). O(log n).
  std::optional<Pose> at(Time time) const;

  struct Gap {
    Time before, after;  ///< of the poses on both sides
  };
  /// The pair of poses around `time` (exclusive) when they differ and lie more than kMaxGap apart. Poses that agree to
  /// 1 nm and 1 nrad are a body that stood still, however long. O(log n).
  std::optional<Gap> gap_at(Time time) const;
  /// Whether nothing is known between two poses that follow each other.
  static bool is_gap(const StampedPose& before, const StampedPose& after);

  Time begin() const { return poses_.front().time; }
  Time end() const { return poses_.back().time; }
  const std::vector<StampedPose>& poses() const { return poses_; }

 private:
  std::vector<StampedPose>::const_iterator first_after(Time time) const;

  std::vector<StampedPose> poses_;
  bool fixed_ = false;
};

}  // namespace scree
