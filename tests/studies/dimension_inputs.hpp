#pragma once
// What the study of D looks at: all elevation models and surveys of the data, parts and changes of them, and rooms.

#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/depth_recording.hpp"

namespace scree::study {

namespace fs = std::filesystem;

struct Input {
  std::string name;
  fs::path path;
  std::vector<std::string> options;
};

inline std::vector<Input> terrain(const fs::path& data) {
  const std::vector<std::string> whole{"--noise-sigma-m", "0.289"};  // rounding to whole metres: 1/√12
  const fs::path landlab = data / "landlab_dems", clouds = data / "libpointmatcher_clouds";
  return {
      {"Big Tujunga, SRTM 30 m", data / "bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif", {}},
      {"", data / "bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif", whole},
      {"Jacksboro fault, SRTM 74 × 92 m", data / "matplotlib_dems/jacksboro_fault_dem.asc", {}},
      {"", data / "matplotlib_dems/jacksboro_fault_dem.asc", whole},
      {"Colorado front range, SRTM 3″", landlab / "srtmgl3_colorado_front_range.asc", {}},
      {"", landlab / "srtmgl3_colorado_front_range.asc", {"--geographic"}},
      {"Bijou gully, 5 m, pits filled", landlab / "bijou_gully_5m.asc", {}},
      {"West Bijou gully, 3 m", landlab / "west_bijou_gully_3m.asc", {}},
      {"Runout slope, 10 m", landlab / "pre_runout_10m.asc", {}},
      {"Lone Star, terrestrial laser", data / "pdal_lonestar_tls/lone-star_local_xyzi.bin", {}},
      {"", data / "pdal_lonestar_tls/lone-star_local_xyzi.bin", {"--noise-sigma-m", "auto"}},
      {"Car lidar, cloud 400", clouds / "car_cloud400.csv", {}},
      {"", clouds / "car_cloud400.csv", {"--noise-sigma-m", "auto"}},
      {"Car lidar, cloud 401", clouds / "car_cloud401.csv", {}},
      {"Perceptron file, synthetic", data / "perceptron_SYNTHETIC/synthetic_msh.perc", {}},
  };
}

/// The survey's points over 4 × 4 m of open ground.
inline void write_open_ground(const fs::path& survey, const fs::path& out) {
  std::ifstream in(survey, std::ios::binary);
  std::ofstream file(out);
  for (std::array<float, 4> p{}; in.read(reinterpret_cast<char*>(p.data()), sizeof p);)
    if (p[0] > 20.0F && p[0] < 24.0F && p[1] > 36.0F && p[1] < 40.0F)
      file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
}

/// An ESRI grid with its heights in whole metres.
inline void write_rounded(const fs::path& grid, const fs::path& out) {
  std::ifstream in(grid);
  std::ofstream file(out);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || std::isalpha(static_cast<unsigned char>(line[0])) != 0) {
      file << line << '\n';
      continue;
    }
    std::istringstream values(line);
    for (double z = 0.0; values >> z;) file << std::lround(z) << ' ';
    file << '\n';
  }
}

/// Parts and changes of the same data, to see what a flag is worth.
inline std::vector<Input> derived(const fs::path& data, const fs::path& folder) {
  const fs::path ground = folder / "open_ground.xyz", rounded = folder / "bijou_rounded.asc";
  write_open_ground(data / "pdal_lonestar_tls/lone-star_local_xyzi.bin", ground);
  write_rounded(data / "landlab_dems/bijou_gully_5m.asc", rounded);
  return {{"Lone Star, 4 × 4 m of open ground", ground, {}},
          {"", ground, {"--noise-sigma-m", "0.005"}},
          {"", ground, {"--noise-sigma-m", "auto"}},
          {"Bijou gully in whole metres", rounded, {}},
          {"", rounded, {"--noise-sigma-m", "0.289"}}};
}

/// Rooms, not ground: what the tool says when it is asked all the same.
inline std::vector<Input> rooms(const fs::path& data, const fs::path& folder) {
  std::vector<Input> inputs{{"Kinect, office", folder / "kinect", {}}};
  test::write_kinect_recording(data / "rgbd_kinect_slambook2", folder / "kinect");
  for (const std::string name : {"one_cloud", "hand"}) {
    test::write_realsense_recording(data / "realsense_d435_bag" / (name + "_depth_z16_848x480.pgm"), folder / name);
    inputs.push_back({"D435, " + name, folder / name, {}});
  }
  return inputs;
}

}  // namespace scree::study
