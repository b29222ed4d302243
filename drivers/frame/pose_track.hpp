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

class PoseTrack {
 public:
  /// Poses in strictly increasing time, finite, quaternions of norm 1 ± 1e-3 (they are normalised). Errors: bad_data
  /// that names the pose's index. A track of one pose is valid at every time (a static sensor).
  static Result<PoseTrack> make(std::vector<StampedPose> poses);

  /// Linear in translation, slerp in rotation; nothing outside [begin, end]. O(log n).
  std::optional<Pose> at(Time time) const;

  Time begin() const { return poses_.front().time; }
  Time end() const { return poses_.back().time; }
  const std::vector<StampedPose>& poses() const { return poses_; }

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace scree
