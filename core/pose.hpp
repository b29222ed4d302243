#pragma once
// Rigid transforms. A Pose named T_a_b takes coordinates in b to coordinates in a.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace scree {

/// Rotation then translation, double precision, metres; `rotation` is a unit quaternion.
struct Pose {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation_m; }
  /// T_a_b * T_b_c = T_a_c
  Pose operator*(const Pose& other) const {
    return {rotation * other.translation_m + translation_m, (rotation * other.rotation).normalized()};
  }
  Pose inverse() const { return {rotation.conjugate() * -translation_m, rotation.conjugate()}; }
};

/// To a fixed point: a rotation that was normalised before, and written and read since, keeps its bits (the squared
/// norm of a normalised one is within some 4 roundings of 1).
inline void normalise(Pose& pose) {
  constexpr double kRounding = 1e-15;
  if (std::abs(pose.rotation.squaredNorm() - 1.0) > kRounding) pose.rotation.normalize();
}

}  // namespace scree
