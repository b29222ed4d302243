#include "node/survey_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <system_error>
#include <tuple>

#include "fractal/dimension_estimate.hpp"
#include "io/point_cloud.hpp"
#include "node/survey_readers.hpp"

namespace scree::node {
namespace {

constexpr std::array<std::string_view, 6> kPointFiles{".bin", ".pcd", ".ply", ".xyz", ".txt", ".csv"};

enum class Kind { points, raster, recording };

Kind kind_of(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::string extension = file.extension().string();
  if (std::filesystem::is_directory(file, ignored) || extension == ".perc") return Kind::recording;
  return std::find(kPointFiles.begin(), kPointFiles.end(), extension) != kPointFiles.end() ? Kind::points
                                                                                           : Kind::raster;
}

Status check_options(const std::filesystem::path& file, Kind kind, const SurveyReading& reading) {
  if (reading.geographic && kind != Kind::raster)
    return Error{ErrorKind::usage,
                 fmt::format("{}: --geographic scales rasters in degrees; points must be in metres", file.string())};
  if (kind != Kind::recording && (reading.frames > 0 || reading.format != "auto"))
    return Error{ErrorKind::usage, fmt::format("{}: --frames and --format go with a recording", file.string())};
  return {};
}

/// Longitude and latitude give themselves away as a raster's do: heights of metres over ten-thousandths of a "metre".
Status refuse_degrees(const SurveyInput& survey, const std::string& name) {
  const auto& [x, y, z] = std::tie(survey.all.x_m, survey.all.y_m, survey.all.z_m);
  if (x.size() < fractal::kMinSurveyPoints) return {};  // a few posts may well be higher than they are apart
  const auto [west, east] = std::minmax_element(x.begin(), x.end());
  const auto [south, north] = std::minmax_element(y.begin(), y.end());
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  const auto beyond = [](double origin, float a, float b, double most) {
    return std::max(std::abs(origin + static_cast<double>(a)), std::abs(origin + static_cast<double>(b))) > most;
  };
  if (beyond(survey.origin_m.x(), *west, *east, 360.0) || beyond(survey.origin_m.y(), *south, *north, 90.0)) return {};
  constexpr float kWall = 30.0F;
  const float extent = std::max(*east - *west, *north - *south);
  if (!(extent > 0.0F && *high - *low > kWall * extent)) return {};  // all at one place: no slope at all
  return Error{ErrorKind::bad_data,
               fmt::format("{}: expected points in metres, found {:.3g} of height over an extent of {:.3g}: longitude "
                           "and latitude? Reproject them first, for instance with gdaltransform or pdal",
                           name, *high - *low, extent)};
}

Result<SurveyInput> read_points(const std::filesystem::path& file, const SurveyReading& reading) {
  const auto cloud = io::read_point_cloud(file);
  if (!cloud) return cloud.error();
  SurveyInput survey;
  survey.origin_m = cloud->origin_m;
  survey.skipped = cloud->dropped_non_finite;
  survey.all.reserve(cloud->points.size());
  for (const auto& p : cloud->points) survey.all.push_back(p.x(), p.y(), p.z());
  if (Status status = refuse_degrees(survey, file.string()); !status) return status.error();
  choose_points(survey, reading);
  return survey;
}

}  // namespace

bool SurveyRaster::square() const {
  return std::abs(cell_x_m / cell_y_m - 1.0) < 1e-3;
}

void choose_points(SurveyInput& survey, const SurveyReading& reading) {
  const auto& all = survey.all;
  survey.found = all.size();
  survey.whole_metres = true;
  Choice choice(survey.found, reading.max_points, reading.seed);
  float largest = 0.0F;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double z = static_cast<double>(all.z_m[i]);
    largest = std::max({largest, std::abs(all.x_m[i]), std::abs(all.y_m[i]), std::abs(all.z_m[i])});
    survey.whole_metres &= z + survey.origin_m.z() == std::round(z + survey.origin_m.z());
    if (!choice.take()) continue;
    survey.x_m.push_back(static_cast<double>(all.x_m[i]));
    survey.y_m.push_back(static_cast<double>(all.y_m[i]));
    survey.z_m.push_back(z);
  }
  survey.height_resolution_m = kHalfUlp * static_cast<double>(largest);
}

Result<SurveyInput> read_survey(const std::filesystem::path& file, const SurveyReading& reading) {
  const Kind kind = kind_of(file);
  if (Status status = check_options(file, kind, reading); !status) return status.error();
  if (kind == Kind::recording) return read_recording_survey(file, reading);
  return kind == Kind::points ? read_points(file, reading) : read_raster_survey(file, reading);
}

}  // namespace scree::node
