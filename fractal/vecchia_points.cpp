#include "fractal/vecchia_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <utility>

#include "core/random.hpp"
#include "fractal/plane_fit.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kOrderSeed = 0x7665636368696121, kOrderStream = 0x6f72646572;  // "vecchia!", "order"

Error bad(std::string message) {
  return {ErrorKind::bad_data, "fractal dimension: " + std::move(message)};
}

Status check(const SurveyPoints& survey) {
  const std::size_t n = survey.z_m.size();
  if (survey.x_m.size() != n || survey.y_m.size() != n)
    return bad(fmt::format("expected as many x and y as heights, found {} and {} for {}", survey.x_m.size(),
                           survey.y_m.size(), n));
  for (const double noise : {survey.noise_sigma_m, survey.noise_xy_sigma_m})
    if (!(noise >= 0.0 && std::isfinite(noise)))
      return bad(fmt::format("expected a finite noise of at least 0 m, found {}", noise));
  if (survey.noise_unknown && survey.noise_sigma_m > 0.0)
    return bad(fmt::format("expected a noise that is known or unknown, found {} m given and an estimate asked for",
                           survey.noise_sigma_m));
  if (n < kMinSurveyPoints) return bad(fmt::format("expected at least {} points, found {}", kMinSurveyPoints, n));
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(survey.x_m[i]) || !std::isfinite(survey.y_m[i]) || !std::isfinite(survey.z_m[i]))
      return bad(fmt::format("expected finite coordinates, found ({}, {}, {}) at point {}", survey.x_m[i],
                             survey.y_m[i], survey.z_m[i], i));
  return {};
}

/// Sorted by place, so that what follows does not depend on the order of the input; points at one place averaged.
/// Coordinates relative to the first point: large offsets (UTM) cost no digits later.
std::vector<VecchiaPoint> merged(const SurveyPoints& survey) {
  std::vector<VecchiaPoint> points(survey.z_m.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {survey.x_m[i], survey.y_m[i], survey.z_m[i], 1.0};
  std::sort(points.begin(), points.end(), [](const VecchiaPoint& a, const VecchiaPoint& b) {
    return std::pair(a.x, std::pair(a.y, a.z)) < std::pair(b.x, std::pair(b.y, b.z));
  });
  const VecchiaPoint origin = points.front();
  for (auto& p : points) p.x -= origin.x, p.y -= origin.y, p.z -= origin.z;
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    double sum = 0.0;
    for (; end < points.size() && points[end].x == points[begin].x && points[end].y == points[begin].y; ++end)
      sum += points[end].z;
    const auto count = static_cast<double>(end - begin);
    points[kept++] = {points[begin].x, points[begin].y, sum / count, 1.0 / count};
    begin = end;
  }
  points.resize(kept);
  return points;
}

void shuffle(std::vector<VecchiaPoint>& points) {
  for (std::size_t i = points.size() - 1; i > 0; --i) {
    const auto words = random_words(kOrderSeed, kOrderStream, static_cast<std::int32_t>(i), 0);
    const std::uint64_t word = (std::uint64_t{words[0]} << 32) | words[1];
    std::swap(points[i], points[word % (i + 1)]);
  }
}

double rms_height(const std::vector<VecchiaPoint>& points) {
  double sum = 0.0;
  for (const auto& p : points) sum += p.z * p.z;
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

Box main_box(const std::vector<VecchiaPoint>& points) {
  std::vector<double> values(points.size());
  const auto stretched = [&](double VecchiaPoint::*coordinate) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const auto& p) { return p.*coordinate; });
    const auto quantile = [&](std::size_t tenths) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(tenths * (values.size() - 1) / 10);
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    const double low = quantile(1), high = quantile(9);
    if (high > low) return std::pair(low - 0.125 * (high - low), high + 0.125 * (high - low));
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return std::pair(*least, *most);
  };
  const auto x = stretched(&VecchiaPoint::x), y = stretched(&VecchiaPoint::y);
  return {x.first, x.second, y.first, y.second};
}

Result<VecchiaPoints> prepare_points(const SurveyPoints& survey) {
  if (Status status = check(survey); !status) return status.error();
  VecchiaPoints out;
  out.points = merged(survey);
  auto& points = out.points;
  out.duplicates = survey.z_m.size() - points.size();
  if (points.size() < kMinSurveyPoints)
    return bad(fmt::format("expected points at {} places at least, found {} points at {}", kMinSurveyPoints,
                           survey.z_m.size(), points.size()));
  if (survey.noise_unknown && points.size() < kMinNoisePoints)
    return bad(
        fmt::format("expected points at {} places at least to estimate the noise from, found {}: give the noise "
                    "of the sensor instead",
                    kMinNoisePoints, points.size()));
  const PlaneMoments moments(points.size(), [&points](std::size_t i) { return points[i]; });
  constexpr double kLine = 1e-12;  // a millionth as wide as long: float32 coordinates of a line reach 1e-7
  if (!(moments.flatness() > kLine)) return bad("expected points spread over an area, found them all on one line");
  const auto [lowest, highest] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
  if (lowest->z == highest->z) return bad("expected heights that differ, found them all equal: flat ground has no D");

  const Plane plane = moments.plane();
  for (auto& p : points) {
    p.x -= moments.x, p.y -= moments.y;
    p.z -= moments.z + plane.slope_x * p.x + plane.slope_y * p.y;
  }
  out.slope_x = plane.slope_x, out.slope_y = plane.slope_y;
  out.height_m = rms_height(points);
  constexpr double kRounding = 1e-13;
  const double rounding = std::max(kRounding * (highest->z - lowest->z), 2.0 * survey.height_resolution_m);
  if (!(out.height_m > std::max(rounding, kRounding * std::sqrt(moments.zz / static_cast<double>(points.size())))))
    return bad(fmt::format("expected heights that differ from a plane, found an rms of {:.2g} m: a plane has no D",
                           out.height_m));

  const Box box = main_box(points);
  out.spacing_m = std::sqrt((box.x_max - box.x_min) * (box.y_max - box.y_min) / static_cast<double>(points.size()));
  if (!(out.spacing_m > 0.0)) out.spacing_m = std::sqrt((moments.xx + moments.yy)) / static_cast<double>(points.size());
  for (auto& p : points) p.x /= out.spacing_m, p.y /= out.spacing_m, p.z /= out.height_m;
  out.noise_unknown = survey.noise_unknown;
  const double slope2 = plane.slope_x * plane.slope_x + plane.slope_y * plane.slope_y;
  const double vertical = survey.noise_sigma_m / out.height_m, through_slope = survey.noise_xy_sigma_m / out.height_m;
  out.noise_variance = survey.noise_unknown ? 0.0 : vertical * vertical + slope2 * through_slope * through_slope;
  shuffle(points);
  return out;
}

}  // namespace scree::fractal
