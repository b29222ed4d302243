#include "node/survey_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <numbers>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/random.hpp"
#include "io/point_cloud.hpp"
#include "io/raster.hpp"

namespace scree::node {
namespace {

constexpr std::array<std::string_view, 6> kPointFiles{".bin", ".pcd", ".ply", ".xyz", ".txt", ".csv"};
constexpr std::uint64_t kChoiceStream = 0x7375727665792063;  // "survey c"

/// Lets through `most` of `total` offers, each set of that size being equally likely. Source: Knuth, algorithm S.
class Choice {
 public:
  Choice(std::size_t total, std::size_t most) : left_(total), wanted_(std::min(total, most)) {}
  bool take() {
    const auto at = static_cast<std::uint64_t>(left_);
    const auto words = random_words(0, kChoiceStream, static_cast<std::int32_t>(at & 0xffffffffU),
                                    static_cast<std::int32_t>(at >> 32));
    const bool taken = to_uniform(words[0]) * static_cast<double>(left_--) < static_cast<double>(wanted_);
    if (taken) --wanted_;
    return taken;
  }

 private:
  std::size_t left_, wanted_;
};

void add(SurveyInput& survey, double x, double y, double z) {
  survey.x_m.push_back(x);
  survey.y_m.push_back(y);
  survey.z_m.push_back(z);
}

constexpr double kHalfUlp = 0x1p-24;

Result<SurveyInput> from_points(const std::filesystem::path& file, const SurveyReading& reading) {
  if (reading.geographic)
    return Error{ErrorKind::usage,
                 fmt::format("{}: --geographic scales rasters in degrees; points must be in metres", file.string())};
  const auto cloud = io::read_point_cloud(file);
  if (!cloud) return cloud.error();
  SurveyInput survey;
  survey.found = cloud->points.size();
  survey.skipped = cloud->dropped_non_finite;
  survey.whole_metres = true;
  Choice choice(survey.found, reading.max_points);
  float largest = 0.0F;
  for (const auto& p : cloud->points) {
    largest = std::max(largest, p.head<3>().cwiseAbs().maxCoeff());
    survey.whole_metres &= p.z() + cloud->origin_m.z() == std::round(p.z() + cloud->origin_m.z());
    if (choice.take()) add(survey, p.x(), p.y(), p.z());
  }
  survey.height_resolution_m = kHalfUlp * largest;
  return survey;
}

/// Metres a degree of longitude and of latitude on the WGS 84 ellipsoid, to a metre (series of the arc lengths).
std::pair<double, double> metres_per_degree(double latitude_deg) {
  const double phi = latitude_deg * std::numbers::pi / 180.0;
  return {111412.84 * std::cos(phi) - 93.5 * std::cos(3 * phi) + 0.118 * std::cos(5 * phi),
          111132.92 - 559.82 * std::cos(2 * phi) + 1.175 * std::cos(4 * phi)};
}

Result<SurveyInput> from_raster(const std::filesystem::path& file, const SurveyReading& reading) {
  const auto raster = io::read_raster(file);
  if (!raster) return raster.error();
  const auto& z = raster->height_m;
  double cell_x = raster->cell_m, cell_y = raster->cell_y_m;
  if (raster->geographic && !reading.geographic) {
    Error error = io::geographic_error(*raster, file.string());
    error.message += "; or scale degrees to metres about the middle: --geographic";
    return error;
  }
  if (reading.geographic) {
    if (!raster->geographic)
      return Error{ErrorKind::bad_data,
                   fmt::format("{}: --geographic: expected cells in degrees, found metres", file.string())};
    const auto [per_longitude, per_latitude] = metres_per_degree(raster->y_min_m + 0.5 * z.rows() * cell_y);
    cell_x *= per_longitude, cell_y *= per_latitude;
  }
  SurveyInput survey;
  survey.cells = survey.whole_metres = true;
  float largest = 0.0F;
  for (const float height : z) {
    if (!std::isfinite(height)) continue;
    ++survey.found;
    largest = std::max(largest, std::abs(height));
    survey.whole_metres &= height == std::round(height);
  }
  survey.skipped = z.size() - survey.found;
  survey.height_resolution_m = kHalfUlp * largest;
  Choice choice(survey.found, reading.max_points);
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c)
      if (std::isfinite(z(r, c)) && choice.take()) add(survey, c * cell_x, r * cell_y, z(r, c));
  return survey;
}

}  // namespace

Result<SurveyInput> read_survey(const std::filesystem::path& file, const SurveyReading& reading) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a file of points or a raster, found a directory", file.string())};
  const std::string extension = file.extension().string();
  const bool points = std::find(kPointFiles.begin(), kPointFiles.end(), extension) != kPointFiles.end();
  return points ? from_points(file, reading) : from_raster(file, reading);
}

}  // namespace scree::node
