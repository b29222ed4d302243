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

/// Until a pose at or after `time` is there, the time is max_age old, or `stop`.
bool UdpPoses::wait_for(Time time, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kSlice{20};
  while (now() <= time + max_age_ && !stop.stop_requested())
    if (input_.wait_for(time, kSlice, stop)) return true;
  const auto newest = input_.newest();
  return newest && newest->time + max_age_ >= time;
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
  if (!newest) return false;  // the source has just started again
  frame.T_map_body.resize(frame.row_time.size());
  for (std::size_t row = 0; row < frame.row_time.size(); ++row) {
    const Time time = frame.row_time[row] + to_node_clock;
    const auto pose = time <= newest->time ? input_.at(time) : newest;
    if (!pose) return false;  // from before the first pose
    frame.T_map_body[row] = pose->T_map_body;
    frame.pose_variance = pose->variance;
    delivered_ = pose->delivered;
  }
  return true;
}

}  // namespace scree::node
