#include "node/pose_history.hpp"

#include <cassert>

namespace scree::node {

void PoseHistory::add(const StampedPose& pose, const PoseVariance& variance, MonotonicTime delivered) {
  assert(size() == 0 || pose.time > entry(size() - 1).time);
  if (size() < kCapacity) {
    poses_.push_back({pose.time, pose.T_map_body, variance, delivered});
  } else {
    poses_[begin_] = {pose.time, pose.T_map_body, variance, delivered};
    begin_ = (begin_ + 1) % kCapacity;
  }
}

std::optional<UncertainPose> PoseHistory::at(Time time) const {
  if (size() == 0 || time < entry(0).time || time > entry(size() - 1).time) return std::nullopt;
  std::size_t low = 0, high = size() - 1;  // entry(low).time ≤ time ≤ entry(high).time
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (entry(middle).time <= time ? low : high) = middle;
  }
  const UncertainPose& before = entry(low);
  const UncertainPose& after = entry(high);
  if (after.time == before.time) return before;
  if (PoseTrack::is_gap({before.time, before.T_map_body}, {after.time, after.T_map_body})) return std::nullopt;
  const double weight = to_seconds(time - before.time) / to_seconds(after.time - before.time);
  const Pose& a = before.T_map_body;
  const Pose& b = after.T_map_body;
  const auto between = [weight](const Eigen::Vector3d& u, const Eigen::Vector3d& v) { return u + weight * (v - u); };
  return UncertainPose{time,
                       {between(a.translation_m, b.translation_m), a.rotation.slerp(weight, b.rotation)},
                       {between(before.variance.position_m2, after.variance.position_m2),
                        between(before.variance.attitude_rad2, after.variance.attitude_rad2)},
                       after.delivered};
}

std::optional<UncertainPose> PoseHistory::newest() const {
  if (size() == 0) return std::nullopt;
  return entry(size() - 1);
}

}  // namespace scree::node
