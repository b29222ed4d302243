#pragma once
// Recordings written by hand, byte for byte, over ground whose height is known: flat at z = 0.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <vector>

namespace scree::test {

inline void write_file(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A 160 × 120 depth image of ground 2 m below: 4 m × 3 m of it. P5, big-endian millimetres.
inline std::string flat_depth_image(std::uint16_t depth_mm = 2000) {
  std::string bytes = "P5\n160 120\n65535\n";
  for (int i = 0; i < 160 * 120; ++i) {
    bytes += static_cast<char>(depth_mm >> 8);
    bytes += static_cast<char>(depth_mm & 0xFF);
  }
  return bytes;
}

/// A camera 2 m above the body's origin that looks straight down (its x forward, y to the right, z down).
inline const std::string kDepthRecordingYaml = R"(scree_recording: 1
origin: live
sensor:
  projection: pinhole
  parameters: {rows: 120, columns: 160, fx_px: 80, fy_px: 80, cx_px: 79.5, cy_px: 59.5, depth_unit_m: 0.001, invalid_raw: 0}
  T_body_sensor: {x_m: 0, y_m: 0, z_m: 2, qx: 1, qy: 0, qz: 0, qw: 0}
  row_period_s: 0
  range_min_m: 0.3
  range_max_m: 10
  range_sigma_m: 0.005
)";

/// One frame at each of `times_s`, driven along x at `speed_mps` from x = 0 at t = 0. All frames are one file.
inline std::filesystem::path make_depth_recording(const std::filesystem::path& directory,
                                                  const std::vector<double>& times_s, double speed_mps = 0.0) {
  write_file(directory / "recording.yaml", kDepthRecordingYaml);
  write_file(directory / "frames" / "flat.pgm", flat_depth_image());
  std::string frames = "file,t_s,sequence\n";
  for (std::size_t i = 0; i < times_s.size(); ++i) frames += fmt::format("flat.pgm,{:.6f},{}\n", times_s[i], i);
  write_file(directory / "frames.csv", frames);
  std::string poses = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (int t_s = -1; t_s < 100; ++t_s) poses += fmt::format("{},{},0,0,0,0,0,1\n", t_s, speed_mps * t_s);
  write_file(directory / "poses.csv", poses);
  return directory;
}

inline std::vector<double> every(double period_s, int count, double start_s = 0.0) {
  std::vector<double> times_s;
  for (int i = 0; i < count; ++i) times_s.push_back(start_s + period_s * i);
  return times_s;
}

/// float32 x y z intensity of a 4 m × 4 m square of ground at `z_m`, every 5 cm, around (4, 0): in front of the sensor.
inline std::string flat_cloud(float z_m) {
  std::string bytes;
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) {
      const float point[4] = {2.025f + 0.05f * static_cast<float>(i), -1.975f + 0.05f * static_cast<float>(j), z_m,
                              1.0f};
      bytes.append(reinterpret_cast<const char*>(point), sizeof point);
    }
  return bytes;
}
inline constexpr int kFlatCloudCells = 1600;  ///< of 0.1 m

/// A configuration for `scree run`: plays `recording`.
inline std::filesystem::path live_config(const std::filesystem::path& file, const std::filesystem::path& recording,
                                         const std::string& more = {}) {
  write_file(file, fmt::format("source: {{kind: recording, path: \"{}\"}}\n{}", recording.string(), more));
  return file;
}

}  // namespace scree::test
