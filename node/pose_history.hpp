#pragma once
// The latest poses of a live source.

#include <cstddef>
#include <optional>
#include <vector>

#include "drivers/frame/pose_track.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::node {

struct UncertainPose {
  Time time;
  Pose T_map_body;
  PoseVariance variance;
  MonotonicTime delivered;  ///< to the node
};

/// A ring of the newest 4096 poses (20 s at 200 Hz), strictly increasing in time. No allocation once it is full.
class PoseHistory {
 public:
  static constexpr std::size_t kCapacity = 4096;

  void clear() {
    poses_.clear();
    begin_ = 0;
  }
  /// `pose.time` must be after newest()'s.
  void add(const StampedPose& pose, const PoseVariance& variance = {}, MonotonicTime delivered = {});
  /// Linear in translation and variance, slerp in rotation, delivered with the later pose; nothing outside the
  /// history, nor between two that differ and lie more than PoseTrack::kMaxGap apart. O(log n). Between poses whose
  /// errors are one and the same the variance is no larger than that.
  std::optional<UncertainPose> at(Time time) const;
  std::optional<UncertainPose> newest() const;
  std::size_t size() const { return poses_.size(); }

 private:
  const UncertainPose& entry(std::size_t i) const { return poses_[(begin_ + i) % kCapacity]; }

  std::vector<UncertainPose> poses_;  ///< grows to kCapacity, then is a ring
  std::size_t begin_ = 0;             ///< of the oldest
};

}  // namespace scree::node
