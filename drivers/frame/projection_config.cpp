// Defaults and checks of what a recording or a configuration says about the geometry.

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>

#include "drivers/frame/projection.hpp"

namespace scree {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kUsfLengthPerCount = 0.20236;         // delta, in the set's length unit [HJ96]
constexpr double kCmuRangePerCount_m = 40.0 / 4096.0;  // nominal: about 40 m of ambiguity, 12 bits
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
constexpr double kMaxMetres = 1e6;  // no sensor's constant is larger; keeps every product finite in float

Error wrong(const ProjectionConfig& config, std::string_view key, std::string_view expected, const std::string& found) {
  return {ErrorKind::bad_data,
          fmt::format("projection {}: {}: expected {}, found {}", to_string(config.kind), key, expected, found)};
}

std::optional<Error> check_positive(const ProjectionConfig& config, std::string_view key, double value) {
  if (value > 0.0 && value <= kMaxMetres) return std::nullopt;
  return wrong(config, key, "a positive number", fmt::format("{}", value));
}

std::optional<Error> check_shape(const ProjectionConfig& config, int rows, int columns) {
  if (rows < 1 || columns < 1 || std::int64_t{rows} * columns > kMaxPixels)
    return wrong(config, "image", fmt::format("at least 1 x 1 and at most {} pixels", kMaxPixels),
                 fmt::format("{} x {}", rows, columns));
  if ((config.rows != 0 && config.rows != rows) || (config.columns != 0 && config.columns != columns))
    return wrong(config, "rows, columns", fmt::format("{} x {}", config.rows, config.columns),
                 fmt::format("an image of {} x {}", rows, columns));
  return std::nullopt;
}

void fill_perceptron_defaults(ProjectionConfig& config) {
  const bool usf = config.kind == ProjectionKind::perceptron_usf;
  const double h_deg = usf ? 51.65 : 60.0;
  const double v_deg = usf ? 36.73 : 60.0;
  if (config.field_of_view_rad[0] == 0.0) config.field_of_view_rad[0] = h_deg * kDegree_rad;
  if (config.field_of_view_rad[1] == 0.0) config.field_of_view_rad[1] = v_deg * kDegree_rad;
  if (config.range_per_count_m == 0.0)
    config.range_per_count_m = usf ? kUsfLengthPerCount * config.unit_m : kCmuRangePerCount_m;
  if (config.ambiguity_m == -1.0) config.ambiguity_m = kPerceptronCounts * config.range_per_count_m;
}

/// Beams must stay in the half space in front of the mirrors.
std::optional<Error> check_perceptron(const ProjectionConfig& config) {
  if (auto error = check_positive(config, "range_per_count_m", config.range_per_count_m)) return error;
  for (const double field : config.field_of_view_rad)
    if (!(field > 0.0 && field < std::numbers::pi))
      return wrong(config, "field_of_view_rad", "two angles in (0, pi)", fmt::format("{}", field));
  return std::nullopt;
}

std::optional<Error> check_angles(const ProjectionConfig& config, std::string_view key,
                                  const std::vector<double>& angles, int count, double limit_rad) {
  if (angles.size() != static_cast<std::size_t>(count))
    return wrong(config, key, fmt::format("{} angles", count), fmt::format("{}", angles.size()));
  for (const double angle : angles)
    if (!(std::abs(angle) <= limit_rad))
      return wrong(config, key, fmt::format("angles within ±{:.4f}", limit_rad), fmt::format("{}", angle));
  return std::nullopt;
}

std::optional<Error> check_spherical(const ProjectionConfig& config) {
  constexpr double kSlack_rad = 1e-9;
  if (auto error = check_positive(config, "range_per_count_m", config.range_per_count_m)) return error;
  if (auto error = check_angles(config, "row_elevations_rad", config.row_elevations_rad, config.rows,
                                std::numbers::pi / 2.0 + kSlack_rad))
    return error;
  return check_angles(config, "column_azimuths_rad", config.column_azimuths_rad, config.columns,
                      2.0 * std::numbers::pi + kSlack_rad);
}

/// A principal point of (0, 0) is a forgotten key, not a camera: taking it would bend every point in silence.
std::optional<Error> check_pinhole(const ProjectionConfig& config) {
  if (auto error = check_positive(config, "fx_px", config.fx_px)) return error;
  if (auto error = check_positive(config, "fy_px", config.fy_px)) return error;
  if (auto error = check_positive(config, "depth_unit_m", config.depth_unit_m)) return error;
  if (!(std::abs(config.cx_px) <= kMaxMetres && std::abs(config.cy_px) <= kMaxMetres) ||
      (config.cx_px == 0.0 && config.cy_px == 0.0))
    return wrong(config, "cx_px, cy_px", "the principal point in pixels",
                 fmt::format("({}, {})", config.cx_px, config.cy_px));
  return std::nullopt;
}

std::optional<Error> check_kind(const ProjectionConfig& config) {
  switch (config.kind) {
    case ProjectionKind::perceptron_usf:
      if (auto error = check_positive(config, "unit_m", config.unit_m)) return error;
      return check_perceptron(config);
    case ProjectionKind::perceptron_cmu:
      return check_perceptron(config);
    case ProjectionKind::spherical:
      return check_spherical(config);
    case ProjectionKind::pinhole:
      return check_pinhole(config);
    case ProjectionKind::cloud:
      break;
  }
  return std::nullopt;
}

std::optional<Error> check_common(const ProjectionConfig& config) {
  if (config.trusted_rows < 1 || config.trusted_rows > config.rows)
    return wrong(config, "trusted_rows", fmt::format("1..{}", config.rows), fmt::format("{}", config.trusted_rows));
  if (config.reflectance_shift != 0 && config.reflectance_shift != 12 && config.reflectance_shift != 16)
    return wrong(config, "reflectance_shift", "12, 16 or none", fmt::format("{}", config.reflectance_shift));
  if (config.invalid_raw < -1)
    return wrong(config, "invalid_raw", "a raw count", fmt::format("{}", config.invalid_raw));
  if (!(config.ambiguity_m >= 0.0 && config.ambiguity_m <= kMaxMetres))
    return wrong(config, "ambiguity_m", "0 (none) or a positive number", fmt::format("{}", config.ambiguity_m));
  if (!(std::abs(config.range_offset_m) <= kMaxMetres))
    return wrong(config, "range_offset_m", "a finite number", fmt::format("{}", config.range_offset_m));
  return std::nullopt;
}

}  // namespace

Result<ProjectionConfig> complete_projection(ProjectionConfig config, int rows, int columns) {
  if (auto error = check_shape(config, rows, columns)) return *error;
  config.rows = rows;
  config.columns = columns;
  const bool usf = config.kind == ProjectionKind::perceptron_usf;
  if (config.trusted_rows == -1) config.trusted_rows = usf && rows == 512 && columns == 512 ? 508 : rows;
  if (usf || config.kind == ProjectionKind::perceptron_cmu) fill_perceptron_defaults(config);
  if (config.kind == ProjectionKind::pinhole && config.invalid_raw == -1) config.invalid_raw = 0;
  if (config.ambiguity_m == -1.0) config.ambiguity_m = 0.0;
  if (auto error = check_kind(config)) return *error;
  if (auto error = check_common(config)) return *error;
  return config;
}

}  // namespace scree
