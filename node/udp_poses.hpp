#pragma once
// pose.source udp: frames take their poses from POSE_INPUT messages.

#include <chrono>
#include <stop_token>

#include "node/pose_input.hpp"
#include "node/pose_provider.hpp"

namespace scree::node {

/// A frame waits for the pose of its last row, at most until that row is `max_age` old on the node's clock; then the
/// newest pose stands in if it is younger than `max_age` at the row, else the frame has no fresh pose.
class UdpPoses final : public PoseProvider {
 public:
  /// `input` outlives this. `played`: the frames come from a recording, whose clock is not
  /// the node's: a row's time on the node's clock is the moment the frame was delivered plus its offset in the frame.
  UdpPoses(PoseInput& input, std::chrono::milliseconds max_age, bool played)
      : input_(input), max_age_(max_age), played_(played) {}

  bool provide(RangeFrame& frame, const std::stop_token& stop) override;
  std::optional<MonotonicTime> delivered() const override { return delivered_; }

 private:
  bool wait_for(Time time, const std::stop_token& stop);

  PoseInput& input_;
  std::chrono::milliseconds max_age_;
  bool played_;
  std::optional<MonotonicTime> delivered_;
};

}  // namespace scree::node
