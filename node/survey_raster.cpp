// A DEM as a survey: one point a cell that has data, at its centre.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

#include "node/survey_readers.hpp"

namespace scree::node {
namespace {

/// Metres a degree of longitude and of latitude on the WGS 84 ellipsoid, to a metre (series of the arc lengths).
std::pair<double, double> metres_per_degree(double latitude_deg) {
  const double phi = latitude_deg * std::numbers::pi / 180.0;
  return {111412.84 * std::cos(phi) - 93.5 * std::cos(3 * phi) + 0.118 * std::cos(5 * phi),
          111132.92 - 559.82 * std::cos(2 * phi) + 1.175 * std::cos(4 * phi)};
}

Result<SurveyRaster> in_metres(io::Raster raster, const std::string& name, bool scale_degrees) {
  SurveyRaster out;
  out.cell_x_m = raster.cell_m, out.cell_y_m = raster.cell_y_m;
  if (raster.geographic && !scale_degrees) {
    Error error = io::geographic_error(raster, name);
    error.message += "; or scale degrees to metres about the middle: --geographic";
    return error;
  }
  if (scale_degrees) {
    if (!raster.geographic)
      return Error{ErrorKind::bad_data, fmt::format("{}: --geographic: expected cells in degrees, found metres", name)};
    const double middle_deg = raster.y_min_m + 0.5 * raster.height_m.rows() * raster.cell_y_m;
    const auto [per_longitude, per_latitude] = metres_per_degree(middle_deg);
    out.cell_x_m *= per_longitude, out.cell_y_m *= per_latitude;
  }
  out.raster = std::move(raster);
  return out;
}

}  // namespace

Result<SurveyInput> read_raster_survey(const std::filesystem::path& file, const SurveyReading& reading) {
  auto raster = io::read_raster(file);
  if (!raster) return raster.error();
  auto scaled = in_metres(*std::move(raster), file.string(), reading.geographic);
  if (!scaled) return scaled.error();
  SurveyInput survey;
  survey.whole_metres = true;
  const auto& z = scaled->raster.height_m;
  float largest = 0.0F;
  for (const float height : z) {
    if (!std::isfinite(height)) continue;
    ++survey.found;
    largest = std::max(largest, std::abs(height));
    survey.whole_metres &= height == std::round(height);
  }
  survey.skipped = z.size() - survey.found;
  survey.height_resolution_m = kHalfUlp * static_cast<double>(largest);
  Choice choice(survey.found, reading.max_points, reading.seed);
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      if (!std::isfinite(z(r, c)) || !choice.take()) continue;
      survey.x_m.push_back((c + 0.5) * scaled->cell_x_m);
      survey.y_m.push_back((r + 0.5) * scaled->cell_y_m);
      survey.z_m.push_back(static_cast<double>(z(r, c)));
    }
  survey.raster = *std::move(scaled);
  return survey;
}

}  // namespace scree::node
