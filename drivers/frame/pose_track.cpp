#include "drivers/frame/pose_track.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace scree {
namespace {

constexpr double kNormTolerance = 1e-3;
constexpr double kSame_m = 1e-9;
constexpr double kSame_rad = 1e-9;

bool same(const Pose& a, const Pose& b) {
  return (a.translation_m - b.translation_m).norm() <= kSame_m && a.rotation.angularDistance(b.rotation) <= kSame_rad;
}

Error wrong_pose(std::size_t index, std::string_view expected, const std::string& found) {
  return {ErrorKind::bad_data, fmt::format("pose {}: expected {}, found {}", index, expected, found)};
}

Status check_pose(std::size_t index, const Pose& pose) {
  const auto& t = pose.translation_m;
  const auto& q = pose.rotation.coeffs();
  if (!t.allFinite() || !q.allFinite())
    return wrong_pose(index, "finite numbers",
                      fmt::format("({}, {}, {}; {}, {}, {}, {})", t.x(), t.y(), t.z(), q[0], q[1], q[2], q[3]));
  const double norm = q.norm();
  if (std::abs(norm - 1.0) > kNormTolerance)
    return wrong_pose(index, "a quaternion of norm 1", fmt::format("norm {}", norm));
  return {};
}

}  // namespace

Result<PoseTrack> PoseTrack::make(std::vector<StampedPose> poses) {
  if (poses.empty()) return Error{ErrorKind::bad_data, "poses: expected at least one, found none"};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (auto status = check_pose(i, poses[i].T_map_body); !status) return status.error();
    if (i > 0 && poses[i].time <= poses[i - 1].time)
      return wrong_pose(i, "a time after " + format_seconds(poses[i - 1].time.time_since_epoch()) + " s",
                        format_seconds(poses[i].time.time_since_epoch()) + " s");
    normalise(poses[i].T_map_body);
  }
  PoseTrack track;
  track.poses_ = std::move(poses);
  return track;
}

PoseTrack PoseTrack::fixed(const Pose& T_map_body) {
  PoseTrack track;
  track.poses_ = {{Time{}, T_map_body}};
  track.poses_.front().T_map_body.rotation.normalize();
  track.fixed_ = true;
  return track;
}

std::vector<StampedPose>::const_iterator PoseTrack::first_after(Time time) const {
  return std::upper_bound(poses_.begin(), poses_.end(), time,
                          [](Time t, const StampedPose& pose) { return t < pose.time; });
}

std::optional<PoseTrack::Gap> PoseTrack::gap_at(Time time) const {
  const auto after = first_after(time);
  if (fixed_ || after == poses_.begin() || after == poses_.end()) return std::nullopt;
  const auto before = after - 1;
  if (before->time == time || !is_gap(*before, *after)) return std::nullopt;
  return Gap{before->time, after->time};
}

std::optional<Pose> PoseTrack::at(Time time) const {
  if (fixed_) return poses_.front().T_map_body;
  if (poses_.empty() || time < begin() || time > end() || gap_at(time)) return std::nullopt;
  const auto after = first_after(time);
  if (after == poses_.end()) return poses_.back().T_map_body;
  return interpolate(*(after - 1), *after, time);
}

bool PoseTrack::is_gap(const StampedPose& before, const StampedPose& after) {
  return after.time - before.time > kMaxGap && !same(before.T_map_body, after.T_map_body);
}

Pose interpolate(const StampedPose& before, const StampedPose& after, Time time) {
  const double weight = to_seconds(time - before.time) / to_seconds(after.time - before.time);
  const Pose& a = before.T_map_body;
  const Pose& b = after.T_map_body;
  return {a.translation_m + weight * (b.translation_m - a.translation_m),
          a.rotation.slerp(weight, b.rotation).normalized()};
}

}  // namespace scree
