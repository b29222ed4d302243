#pragma once
// Sensor geometry: where each pixel's ray starts and points, and what its raw number means in metres along that ray.
// Everything is tabulated once per geometry; a frame is then one multiply-add per pixel.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree {

enum class ProjectionKind : std::uint8_t { perceptron_usf, perceptron_cmu, spherical, pinhole, cloud };

inline bool is_perceptron(ProjectionKind kind) {
  return kind == ProjectionKind::perceptron_usf || kind == ProjectionKind::perceptron_cmu;
}

/// One pixel's ray in sensor axes (Perceptron: x left, y up, z out; pinhole: x right, y down, z out; spherical and
/// clouds: x forward, y left, z up). Double precision: the reference that the tables are made from.
struct PixelRay {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double range_offset_m = 0.0;  ///< range along the ray = range_offset_m + raw · range_per_count_m
  double range_per_count_m = 1.0;
};

/// What a recording or a configuration says about the geometry ("sensor.projection" and "sensor.parameters").
struct ProjectionConfig {
  ProjectionKind kind = ProjectionKind::perceptron_usf;
  int rows = 0;  ///< image size; 0 = taken from the first frame
  int columns = 0;
  int trusted_rows = -1;          ///< rows from the top whose ranges are used; -1 = the projection's default
  int reflectance_shift = 0;      ///< 12 | 16; 0 = none (range never depends on it)
  bool lenient = false;           ///< perceptron files: text between header and payload passes, with a warning
  std::int64_t invalid_raw = -1;  ///< raw value that means "no return"; -1 = none declared
  double unit_m = 0.01;           ///< perceptron_usf: metres per length unit of the published constants
  std::array<double, 2> field_of_view_rad{0.0, 0.0};  ///< {H, V}, Perceptron kinds; 0 = the published value
  double range_per_count_m = 0.0;  ///< delta; 0 = the published value (perceptron_*), required for spherical
  double range_offset_m = 0.0;  ///< range at raw 0 (perceptron_cmu, spherical); perceptron_usf: added to the published
                                ///< standoff (drift, calibration); unused by pinhole
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;  ///< pinhole
  double depth_unit_m = 0.001;                                ///< pinhole: metres of depth (z) per count
  double ambiguity_m = -1.0;                ///< phase interval; 0 = unambiguous; -1 = the projection's own
  std::vector<double> row_elevations_rad;   ///< spherical: one per row, up positive
  std::vector<double> column_azimuths_rad;  ///< spherical: one per column, left positive
};

inline constexpr int kPerceptronCounts = 4096;  ///< raw numbers of a Perceptron ambiguity interval (12 bits)

/// The ray of one pixel, in double. For perceptron_usf: the published USF geometry, [HJ96]; see docs/perceptron.md.
/// `config` must be complete (see complete_projection); row 0 is the top, column 0 the left. A `cloud` has no rays of
/// its own: the sensor's z axis from its origin.
PixelRay pixel_ray(const ProjectionConfig& config, int row, int column);

/// The inverse of the range law, for simulators: the (fractional, unwrapped) count at `range_m` along the ray.
inline double count_at_range(const PixelRay& ray, double range_m) {
  return (range_m - ray.range_offset_m) / ray.range_per_count_m;
}

/// What a 12-bit phase sensor reports for an unwrapped count: nearest integer modulo `interval_counts`.
/// `count` must be finite and |count| < 2^62.
std::uint16_t wrapped_count(double count, int interval_counts = kPerceptronCounts);

/// Fills rows, columns, ambiguity_m, trusted_rows and the other "take the default" values for an image of
/// rows × columns, and checks that everything is finite, positive and consistent. Completing twice changes nothing.
/// Defaults: trusted_rows 508 for a 512 × 512 USF image, else all; ambiguity 4096 · range_per_count_m for Perceptron
/// kinds, else none; invalid_raw 0 for depth images. Errors are bad_data and name key, expected and found.
Result<ProjectionConfig> complete_projection(ProjectionConfig config, int rows, int columns);

/// The tables. Immutable, shared by all frames of a source.
struct Projection {
  ProjectionConfig config;  ///< completed
  int rows = 0;
  int columns = 0;
  double ambiguity_m = 0.0;  ///< true range = range + k·ambiguity_m; 0 = unambiguous
  /// Structure of arrays, rows × columns each, sensor axes, metres.
  Grid<float> origin_x_m, origin_y_m, origin_z_m;
  Grid<float> direction_x, direction_y, direction_z;
  Grid<float> range_offset_m, range_per_count_m;

  bool is_image() const {
    return config.kind != ProjectionKind::cloud;
  }  ///< neighbours in the grid are neighbours in space
};

/// Cost: O(rows·columns) trigonometry, once.
Result<std::shared_ptr<const Projection>> make_projection(const ProjectionConfig& config, int rows, int columns);

/// A cloud as a 1 × N projection: each point becomes a ray from the sensor's origin. Points are float32 x y z in
/// sensor axes, non-finite ones are dropped by the caller. Ranges are |p| (also in range_offset_m, with
/// range_per_count_m = 0), so a frame of this projection has range_m = range_offset_m.
std::shared_ptr<const Projection> make_cloud_projection(const std::vector<Eigen::Vector3f>& points_sensor);

const char* to_string(ProjectionKind kind);
Result<ProjectionKind> parse_projection_kind(const std::string& name);

}  // namespace scree
