#pragma once
// The synthetic Perceptron file of the shared data: the configuration that says where its sensor was, and its truth.

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <vector>

#include "core/grid.hpp"
#include "core/pose.hpp"
#include "drivers/frame/projection.hpp"

namespace scree::test {

inline constexpr int kSyntheticSize = 512;

/// Takes Perceptron axes (x left, y up, z out) to body axes.
inline Eigen::Quaterniond body_from_perceptron() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return Eigen::Quaterniond(axes);
}

/// 210 cm up, pitched down 32°, as the file's description says.
inline Pose synthetic_T_body_sensor() {
  const Eigen::AngleAxisd down(32.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
  return {Eigen::Vector3d(0.0, 0.0, 2.1), Eigen::Quaterniond(down) * body_from_perceptron()};
}

inline void write_synthetic_config(const std::filesystem::path& file) {
  const Pose pose = synthetic_T_body_sensor();
  const Eigen::Quaterniond& q = pose.rotation;
  std::ofstream(file) << std::setprecision(17)
                      << "sensor:\n  projection: perceptron_usf\n  parameters: {unit_m: 0.01, reflectance_shift: 12}\n"
                      << "  T_body_sensor: {x_m: 0, y_m: 0, z_m: " << pose.translation_m.z() << ", qx: " << q.x()
                      << ", qy: " << q.y() << ", qz: " << q.z() << ", qw: " << q.w() << "}\n"
                      << "  range_min_m: 0.5\n  range_max_m: 15\n  range_sigma_m: 0.005\n";
}

/// The true surface point of every pixel in the body frame, row by row; NaN where there is no surface.
inline std::vector<Eigen::Vector3d> synthetic_truth(const std::filesystem::path& file, const Pose& T_body_sensor) {
  std::vector<float> distance_cm(kSyntheticSize * kSyntheticSize, 0.0F);
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(distance_cm.data()), static_cast<std::streamsize>(4 * distance_cm.size()));
  const auto config = complete_projection({}, kSyntheticSize, kSyntheticSize);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kSyntheticSize * kSyntheticSize; ++i) {
    const PixelRay ray = pixel_ray(*config, i / kSyntheticSize, i % kSyntheticSize);
    const double t_m = 0.01 * static_cast<double>(distance_cm[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d sensor = ray.origin_m + t_m * ray.direction;
    points.push_back(t_m > 0.0 ? T_body_sensor * sensor : Eigen::Vector3d::Constant(std::nan("")));
  }
  return points;
}

}  // namespace scree::test
