#pragma once
// Any input of the offline commands as scattered points.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/result.hpp"

namespace scree::node {

struct SurveyReading {
  bool geographic = false;  ///< scale a raster in degrees to metres about its middle instead of refusing it
  std::size_t max_points = 200'000;
};

/// Coordinates in metres from an arbitrary origin.
struct SurveyInput {
  std::vector<double> x_m, y_m, z_m;
  std::size_t found = 0;             ///< usable points in the input; more than here where it was sampled
  std::size_t skipped = 0;           ///< points that are not finite, cells without data
  bool cells = false;                ///< of a raster, at their centres
  bool whole_metres = false;         ///< every height is one: rounding is a noise of 0.29 m
  double height_resolution_m = 0.0;  ///< rounding of float32
};

/// Point files by their extension (io::read_point_cloud), anything else as a raster (io::read_raster). Of more than
/// `max_points` a random choice is taken, the same every time. Errors: those of the two readers; bad_data for a raster
/// in degrees without `geographic`, and the other way round.
Result<SurveyInput> read_survey(const std::filesystem::path& file, const SurveyReading& reading);

}  // namespace scree::node
