#include "node/udp_poses.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "core/time.hpp"

namespace scree::node {
namespace {

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace

/// Listens until a pose at or after `time` is there, the time is max_age old, or `stop`.
bool UdpPoses::wait_for(Time time, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kSlice{20};
  for (;;) {
    const bool expired = now() > time + max_age_;
    // even when it is too late to wait, what has arrived is read
    const auto received = input_.poll(expired ? std::chrono::milliseconds(0) : kSlice);
    const auto newest = input_.newest();
    if (newest && newest->time >= time) return true;
    if (!received || stop.stop_requested()) return false;
    if (expired && !*received) return newest && newest->time + max_age_ >= time;
  }
}

bool UdpPoses::provide(RangeFrame& frame, const std::stop_token& stop) {
  if (frame.row_time.empty()) return false;
  Duration to_node_clock{0};
  if (played_) {
    const auto since_delivery = MonotonicClock::now() - frame.received;
    to_node_clock = now() - since_delivery - frame.time;
  }
  if (!wait_for(frame.row_time.back() + to_node_clock, stop)) return false;
  const auto newest = input_.newest();
  frame.T_map_body.resize(frame.row_time.size());
  for (std::size_t row = 0; row < frame.row_time.size(); ++row) {
    const Time time = frame.row_time[row] + to_node_clock;
    const auto pose = time <= newest->time ? input_.at(time) : newest;
    if (!pose) return false;  // from before the first pose
    frame.T_map_body[row] = pose->T_map_body;
    frame.pose_variance = pose->variance;
  }
  return true;
}

}  // namespace scree::node
