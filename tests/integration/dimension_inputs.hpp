#pragma once
// Surveys of known dimension as files, for `scree dimension`.

#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {

inline constexpr double kDimension = 2.4, kAmplitude = 0.2, kCell = 0.5;

/// Exact fBm as an ESRI grid, a third of its cells without data.
inline std::string esri_grid(double cell, double x, double y, bool empty = false) {
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 60, 60, kCell, 11);
  std::ostringstream text;
  text.precision(9);
  text << "ncols 60\nnrows 60\nxllcorner " << x << "\nyllcorner " << y << "\ncellsize " << cell
       << "\nNODATA_value -9999\n";
  for (int r = 0; r < 60; ++r, text << '\n')
    for (int c = 0; c < 60; ++c)
      text << (empty || to_uniform(random_words(1, 2, c, r)[0]) < 0.33 ? -9999.0F : surface(r, c)) << ' ';
  return text.str();
}

inline std::string write(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return (folder / name).string();
}

inline nlohmann::json estimate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "dimension");
  arguments.push_back("--json");
  const auto finished = scree(arguments);
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return nlohmann::json::parse(finished.out);
}

/// 50 × 50 points of an exact surface, half a metre apart, with noise of `sigma_m` on the heights and `xy_m` on both
/// coordinates, stretched along x.
inline std::string noisy_points(const TemporaryFolder& folder, double sigma_m, double xy_m, double stretch = 1.0) {
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 50, 50, kCell, 14);
  std::ostringstream text;
  text.precision(9);
  for (int r = 0; r < 50; ++r)
    for (int c = 0; c < 50; ++c) {
      const auto n = random_normals(5, 6, c, r), m = random_normals(5, 7, c, r);
      text << stretch * (kCell * c + xy_m * m[0]) << ' ' << kCell * r + xy_m * m[1] << ' '
           << surface(r, c) + sigma_m * n[0] << '\n';
    }
  return write(folder, "noisy.xyz", text.str());
}

}  // namespace scree::test
