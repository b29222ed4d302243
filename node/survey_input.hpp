#pragma once
// Any input of the offline commands as scattered points.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/frame/point_frame.hpp"
#include "fractal/structure_function.hpp"
#include "io/raster.hpp"

namespace scree::node {

struct SurveyReading {
  bool geographic = false;  ///< scale a raster in degrees to metres about its middle instead of refusing it
  std::size_t max_points = 200'000;
  std::uint64_t seed = 1;       ///< which points are chosen of more
  std::string format = "auto";  ///< of a directory: auto (a recording of Scree), kitti, pcd
  std::size_t frames = 0;       ///< of a recording: at most so many; 0 = all
};

/// A raster as the survey read it, with the size of its cells in metres (after scaling degrees).
struct SurveyRaster {
  io::Raster raster;
  double cell_x_m = 1.0, cell_y_m = 1.0;
  bool square() const;  ///< to 0.1 %
};

/// What a recording says of itself, beside its points.
struct SurveyFrames {
  std::size_t frames = 0;
  std::size_t skipped_frames = 0;  ///< that could not be read
  PixelCounts counts;
  double noise_sigma_m = 0.0;     ///< of a height by the sensor's own model, rms over the points
  double noise_xy_sigma_m = 0.0;  ///< of each horizontal coordinate
};

/// Coordinates in metres from `origin_m`.
struct SurveyInput {
  std::vector<double> x_m, y_m, z_m;  ///< the estimator's points
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  fractal::PointColumns all;           ///< every point, same origin; empty for a raster
  std::optional<SurveyRaster> raster;  ///< of a raster: every cell
  std::optional<SurveyFrames> frames;  ///< of a recording
  std::size_t found = 0;               ///< usable points in the input; more than in x_m where it was sampled
  std::size_t skipped = 0;           ///< points that are not finite, cells without data, pixels that were filtered out
  bool whole_metres = false;         ///< every height is one: rounding is a noise of 0.29 m
  double height_resolution_m = 0.0;  ///< rounding of float32

  bool cells() const { return raster.has_value(); }  ///< points are at the centres of cells
};

/// Directories and .perc files as recordings (open_input), point files by their extension (io::read_point_cloud),
/// anything else as a raster (io::read_raster). Of more than `max_points` a random choice is taken, the same every
/// time. Errors: those of the readers; bad_data for a raster in degrees without `geographic`, and the other way round;
/// usage for an option that does not go with the input.
Result<SurveyInput> read_survey(const std::filesystem::path& file, const SurveyReading& reading);

}  // namespace scree::node
