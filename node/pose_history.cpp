#include "node/pose_history.hpp"

#include <cassert>

namespace scree::node {

void PoseHistory::add(const StampedPose& pose) {
  assert(size() == 0 || pose.time > entry(size() - 1).time);
  if (size() < kCapacity) {
    poses_.push_back(pose);
  } else {
    poses_[begin_] = pose;
    begin_ = (begin_ + 1) % kCapacity;
  }
}

std::optional<Pose> PoseHistory::at(Time time) const {
  if (size() == 0 || time < entry(0).time || time > entry(size() - 1).time) return std::nullopt;
  std::size_t low = 0, high = size() - 1;  // entry(low).time ≤ time ≤ entry(high).time
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (entry(middle).time <= time ? low : high) = middle;
  }
  const StampedPose& before = entry(low);
  const StampedPose& after = entry(high);
  if (after.time == before.time) return before.T_map_body;
  const double weight = to_seconds(time - before.time) / to_seconds(after.time - before.time);
  const Pose& a = before.T_map_body;
  const Pose& b = after.T_map_body;
  return Pose{a.translation_m + weight * (b.translation_m - a.translation_m), a.rotation.slerp(weight, b.rotation)};
}

std::optional<StampedPose> PoseHistory::newest() const {
  if (size() == 0) return std::nullopt;
  return entry(size() - 1);
}

}  // namespace scree::node
