// POSE_INPUT and POSE: the same pose, towards the node and from it.

#include <cmath>

#include "node/protocol_bytes.hpp"
#include "node/protocol_messages.hpp"

namespace scree::node::protocol {
namespace {

constexpr double kNormTolerance = 1e-3;  // as PoseTrack's

void put_pose(ByteWriter& writer, Time time, const Pose& pose, const std::array<float, 6>& variances) {
  writer.put(static_cast<std::int64_t>(time.time_since_epoch().count()));
  for (int axis = 0; axis < 3; ++axis) writer.f64(pose.translation_m[axis]);
  writer.f64(pose.rotation.x());
  writer.f64(pose.rotation.y());
  writer.f64(pose.rotation.z());
  writer.f64(pose.rotation.w());
  for (const float variance : variances) writer.f32(variance);
}

bool get_pose(ByteReader& reader, Time& time, Pose& pose, std::array<float, 6>& variances) {
  time = Time(Duration(reader.get<std::int64_t>()));
  for (int axis = 0; axis < 3; ++axis) pose.translation_m[axis] = reader.f64();
  const double qx = reader.f64(), qy = reader.f64(), qz = reader.f64(), qw = reader.f64();
  pose.rotation = Eigen::Quaterniond(qw, qx, qy, qz);
  // differences of two accepted times fit 64 bits, those of two positions a double; all written so that NaN fails too
  if (time > Time(kMaxPoseTime) || time < Time(-kMaxPoseTime)) return false;
  if (!(pose.translation_m.cwiseAbs().maxCoeff() <= kMaxPoseCoordinate_m)) return false;
  if (!pose.translation_m.allFinite()) return false;  // maxCoeff may pass over a NaN
  if (!(std::abs(pose.rotation.norm() - 1.0) <= kNormTolerance)) return false;
  pose.rotation.normalize();
  for (float& variance : variances) {
    variance = reader.f32();
    if (!std::isfinite(variance) || variance < 0.0f) return false;
  }
  return true;
}

}  // namespace

void encode(Header header, const PoseInputMessage& message, Datagram& out, const Key* key) {
  header.type = MessageType::pose_input;
  ByteWriter writer(out.body());
  put_pose(writer, message.time, message.T_map_body, message.variances);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, PoseInputMessage& out) {
  if (opened.body.size() < kPoseInputBytes || !body_ends_at(opened, kPoseInputBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  return get_pose(reader, out.time, out.T_map_body, out.variances) ? Reject::none : Reject::body_value;
}

void encode(Header header, const PoseMessage& message, Datagram& out, const Key* key) {
  header.type = MessageType::pose;
  ByteWriter writer(out.body());
  put_pose(writer, message.time, message.T_map_body, message.variances);
  writer.put(message.age_us);
  writer.zeros(4);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, PoseMessage& out) {
  if (opened.body.size() < kPoseBytes || !body_ends_at(opened, kPoseBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  if (!get_pose(reader, out.time, out.T_map_body, out.variances)) return Reject::body_value;
  out.age_us = reader.get<std::uint32_t>();
  return Reject::none;
}

}  // namespace scree::node::protocol
