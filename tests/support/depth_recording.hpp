#pragma once
// Recordings made from single depth images: copies of the images, the two tables and a recording.yaml.

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include "core/pose.hpp"

namespace scree::test {

/// Takes camera axes (x right, y down, z out) to body axes (x forward, y left, z up).
inline Eigen::Quaterniond body_from_camera() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(axes);
}

struct DepthRecording {
  std::vector<std::filesystem::path> images;
  std::vector<Pose> T_map_body;  ///< one an image; images are one second apart
  std::string intrinsics;        ///< "fx_px: 518, …"
};

inline void write_depth_recording(const DepthRecording& from, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory / "frames");
  const Eigen::Quaterniond q = body_from_camera();
  std::ofstream yaml(directory / "recording.yaml");
  yaml << std::setprecision(17) << "scree_recording: 1\norigin: live\nsensor:\n  projection: pinhole\n  parameters: {"
       << from.intrinsics
       << ", depth_unit_m: 0.001, invalid_raw: 0}\n  T_body_sensor: {x_m: 0, y_m: 0, z_m: 0, qx: " << q.x()
       << ", qy: " << q.y() << ", qz: " << q.z() << ", qw: " << q.w() << "}\n  range_min_m: 0.3\n"
       << "  range_max_m: 10\n  range_sigma_m: 0.001\n  range_sigma_per_m2: 0.0025\n";
  std::ofstream frames(directory / "frames.csv"), poses(directory / "poses.csv");
  frames << "file,t_s,sequence\n";
  poses << std::setprecision(17) << "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (std::size_t i = 0; i < from.images.size(); ++i) {
    const std::string name = "00000" + std::to_string(i) + ".pgm";
    std::filesystem::copy_file(from.images[i], directory / "frames" / name);
    frames << "frames/" << name << "," << i << "," << i << "\n";
    const Pose& pose = from.T_map_body[i];
    poses << i << "," << pose.translation_m.x() << "," << pose.translation_m.y() << "," << pose.translation_m.z() << ","
          << pose.rotation.x() << "," << pose.rotation.y() << "," << pose.rotation.z() << "," << pose.rotation.w()
          << "\n";
  }
}

/// The upward normal of the Kinect room's floor in the world of its poses, turned to body axes, and the world origin's
/// height above it. The world is the first camera's, which looked 17° down; found as the plane that holds 32 % of the
/// points of the five frames within 5 cm (nothing lies 0.1 m below it).
inline const Eigen::Vector3d kKinectFloorNormal{-0.29976, 0.08366, 0.95034};
constexpr double kKinectFloor_m = 1.405;

/// The Kinect frames of `data` (depth_1.pgm … depth_5.pgm) with their camera-to-world poses. Both sides of each pose
/// are turned from camera to body axes, and the world is put level with the floor at 0.
inline void write_kinect_recording(const std::filesystem::path& data, const std::filesystem::path& directory) {
  DepthRecording recording;
  recording.intrinsics = "fx_px: 518, fy_px: 519, cx_px: 325.5, cy_px: 253.5";
  const Pose turn{Eigen::Vector3d::Zero(), body_from_camera()};
  const Pose level{Eigen::Vector3d(0, 0, kKinectFloor_m),
                   Eigen::Quaterniond::FromTwoVectors(kKinectFloorNormal, Eigen::Vector3d::UnitZ())};
  std::ifstream poses(data / "pose.txt");
  for (int i = 1; i <= 5; ++i) {
    Pose camera;
    poses >> camera.translation_m.x() >> camera.translation_m.y() >> camera.translation_m.z() >> camera.rotation.x() >>
        camera.rotation.y() >> camera.rotation.z() >> camera.rotation.w();
    camera.rotation.normalize();
    recording.images.push_back(data / ("depth_" + std::to_string(i) + ".pgm"));
    recording.T_map_body.push_back(level * turn * camera * turn.inverse());
  }
  write_depth_recording(recording, directory);
}

/// One RealSense D435 image, the camera at the origin and level.
inline void write_realsense_recording(const std::filesystem::path& image, const std::filesystem::path& directory) {
  write_depth_recording({{image}, {Pose{}}, "fx_px: 424.0653, fy_px: 424.0653, cx_px: 423.9442, cy_px: 240.8047"},
                        directory);
}

}  // namespace scree::test
