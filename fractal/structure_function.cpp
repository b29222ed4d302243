#include "fractal/structure_function.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "fractal/pair_routes.hpp"

namespace scree::fractal {
namespace {

constexpr int kMaxAnnuli = 65536;

Error usage(std::string message) {
  return {ErrorKind::usage, "structure function: " + std::move(message)};
}

bool finite(const std::vector<float>& column) {
  return std::all_of(column.begin(), column.end(), [](float value) { return std::isfinite(value); });
}

Status check(const PointColumns& points) {
  const auto bad = [](std::string message) { return Error{ErrorKind::bad_data, std::move(message)}; };
  const std::size_t count = points.z_m.size();
  if (points.x_m.size() != count || points.y_m.size() != count)
    return bad(fmt::format("points: expected columns of one length, found {} x, {} y, {} z", points.x_m.size(),
                           points.y_m.size(), count));
  if (count < 2 || count >= std::numeric_limits<int>::max())
    return bad(fmt::format("points: expected at least 2 and below 2^31, found {}", count));
  if (!finite(points.x_m) || !finite(points.y_m) || !finite(points.z_m))
    return bad("points: expected finite coordinates, found one that is not");
  return {};
}

/// √(area of the bounding box / N); on a line its length / N.
double mean_spacing_m(const PointColumns& points) {
  const auto [x0, x1] = std::minmax_element(points.x_m.begin(), points.x_m.end());
  const auto [y0, y1] = std::minmax_element(points.y_m.begin(), points.y_m.end());
  const double width = double{*x1} - *x0, height = double{*y1} - *y0;
  const auto count = static_cast<double>(points.size());
  return width > 0.0 && height > 0.0 ? std::sqrt(width * height / count) : std::max(width, height) / count;
}

}  // namespace

Status check_annuli(const Annuli& annuli) {
  const bool uniform = annuli.spacing == Annuli::Spacing::uniform;
  if (annuli.count < 1 || annuli.count > kMaxAnnuli)
    return usage(fmt::format("expected 1 to {} annuli, found {}", kMaxAnnuli, annuli.count));
  if (!(annuli.first_m > 0.0 && std::isfinite(annuli.first_m)))
    return usage(fmt::format("expected a finite first distance > 0, found {} m", annuli.first_m));
  if (!(annuli.step > (uniform ? 0.0 : 1.0) && std::isfinite(annuli.step)))
    return usage(uniform ? fmt::format("expected a finite step > 0 between annuli, found {} m", annuli.step)
                         : fmt::format("expected a finite ratio > 1 between annuli, found {}", annuli.step));
  const double widest = 0.5 * (uniform ? annuli.step : std::log(annuli.step));
  if (!(annuli.half_width > 0.0 && annuli.half_width <= widest * (1.0 + 1e-12)))
    return usage(fmt::format("expected a half-width above 0 and at most {} (annuli do not overlap), found {}", widest,
                             annuli.half_width));
  if (!(annuli.inner_m(0) > 0.0))
    return usage(fmt::format("expected annuli that begin above 0, found {} m", annuli.inner_m(0)));
  return {};
}

void PointColumns::reserve(std::size_t count) {
  for (auto* column : {&x_m, &y_m, &z_m}) column->reserve(count);
}

void PointColumns::push_back(float x, float y, float z) {
  x_m.push_back(x);
  y_m.push_back(y);
  z_m.push_back(z);
}

double Annuli::distance_m(int i) const {
  return spacing == Spacing::uniform ? first_m + i * step : first_m * std::pow(step, i);
}

double Annuli::inner_m(int i) const {
  return spacing == Spacing::uniform ? distance_m(i) - half_width : distance_m(i) * std::exp(-half_width);
}

double Annuli::outer_m(int i) const {
  return spacing == Spacing::uniform ? distance_m(i) + half_width : distance_m(i) * std::exp(half_width);
}

Annuli uniform_annuli(double step_m, double last_m) {
  const double count = std::floor(last_m / step_m + 1e-9);
  return {Annuli::Spacing::uniform, step_m, step_m, static_cast<int>(std::clamp(count, 0.0, kMaxAnnuli + 1.0)),
          0.5 * step_m};
}

Annuli geometric_annuli(double first_m, double ratio, double last_m) {
  const double count = std::floor(std::log(last_m / first_m) / std::log(ratio) + 1e-9) + 1.0;
  return {Annuli::Spacing::geometric, first_m, ratio, static_cast<int>(std::clamp(count, 0.0, kMaxAnnuli + 1.0)),
          0.5 * std::log(ratio)};
}

Result<StructureFunction> structure_function(const PointColumns& points, const Annuli& annuli,
                                             const PairOptions& options, Executor& executor) {
  if (Status status = check_annuli(annuli); !status) return status.error();
  if (Status status = check(points); !status) return status.error();
  if (!(options.spacing_m >= 0.0 && std::isfinite(options.spacing_m)))
    return usage(fmt::format("expected a finite spacing >= 0 (0 = from the points), found {} m", options.spacing_m));
  if (!(options.thinning_density > 0.0))
    return usage(fmt::format("expected a thinning density > 0, found {}", options.thinning_density));
  switch (options.route) {
    case PairRoute::reference:
      return reference_pairs(points, annuli, executor);
    case PairRoute::all_pairs:
      return all_pairs(points, annuli, executor);
    case PairRoute::near_pairs:
      return near_pairs(points, annuli, executor);
    default:
      break;
  }
  const double spacing_m = options.spacing_m > 0.0 ? options.spacing_m : mean_spacing_m(points);
  if (!(spacing_m > 0.0)) return Error{ErrorKind::bad_data, "points: expected different positions, found one"};
  if (options.route == PairRoute::thinned) return thinned_pairs(points, annuli, options, spacing_m, executor);
  return lattice_pairs(points, annuli, spacing_m, executor);
}

}  // namespace scree::fractal
