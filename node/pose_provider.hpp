#pragma once
// Poses for frames that do not bring their own.

#include <optional>
#include <stop_token>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::node {

class PoseProvider {
 public:
  virtual ~PoseProvider() = default;
  /// Sets frame.T_map_body for every row. May wait for a pose that is still on its way, never past `stop`. False when
  /// there is no fresh one: the frame must not be mapped.
  virtual bool provide(RangeFrame& frame, const std::stop_token& stop) = 0;
  /// When the node got the pose that it provided last; none = it comes with the frame, or always held.
  virtual std::optional<MonotonicTime> delivered() const { return std::nullopt; }
};

/// pose.source static: the robot stands still.
class StaticPose final : public PoseProvider {
 public:
  explicit StaticPose(const Pose& T_map_body) : T_map_body_(T_map_body) {}
  bool provide(RangeFrame& frame, const std::stop_token&) override {
    frame.T_map_body.assign(frame.row_time.size(), T_map_body_);
    return true;
  }

 private:
  Pose T_map_body_;
};

}  // namespace scree::node
