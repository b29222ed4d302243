#include "fractal/moment_dimension.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

#include "fractal/moment_interval.hpp"
#include "fractal/vecchia_points.hpp"

namespace scree::fractal {
namespace {

constexpr double kRatio = 1.189207115002721;  // 2^¼
constexpr std::size_t kLeastAnnuli = 5;
constexpr double kMostPairs = 1e9;    // two seconds of one core
constexpr double kMostLattice = 3e7;  // padded cells

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The heights as they were, one a place, relative to the means: float32 keeps what differs.
PointColumns columns_of(const VecchiaPoints& prepared) {
  PointColumns columns;
  columns.reserve(prepared.points.size());
  for (const VecchiaPoint& p : prepared.points) {
    const double x_m = p.x * prepared.spacing_m, y_m = p.y * prepared.spacing_m;
    const double z_m = p.z * prepared.height_m + prepared.slope_x * x_m + prepared.slope_y * y_m;
    columns.push_back(static_cast<float>(x_m), static_cast<float>(y_m), static_cast<float>(z_m));
  }
  return columns;
}

std::size_t known_cells(const Grid<float>& height_m) {
  return static_cast<std::size_t>(
      std::count_if(height_m.begin(), height_m.end(), [](float z) { return std::isfinite(z); }));
}

/// Heights relative to their mean.
Grid<float> levelled(const Grid<float>& height_m, double mean_m) {
  Grid<float> out = height_m;
  for (float& z : out) z = static_cast<float>(static_cast<double>(z) - mean_m);
  return out;
}

/// Far enough for a line, near enough for many independent pairs.
double longest_lag(double spacing_m, double side_m, double wanted_m) {
  if (wanted_m > 0.0) return wanted_m;
  return std::max(side_m / 4.0, std::min(side_m / 2.0, 4.0 * spacing_m));
}

bool fits_lattice(const MomentOptions& options, double last_m) {
  if (options.lattice_m == nullptr || options.moment != Moment::second) return false;
  const double reach = 1.1 * last_m / options.lattice_cell_m;
  const double cells = (options.lattice_m->rows() + reach) * (options.lattice_m->columns() + reach);
  return cells < kMostLattice;
}

Result<StructureFunction> pair_sums(const SurveyPoints& survey, const VecchiaPoints& prepared,
                                    const MomentOptions& options, double last_m, Executor& executor, PairRoute& route) {
  const double spacing_m = prepared.spacing_m;
  if (fits_lattice(options, last_m)) {
    route = PairRoute::lattice;
    const auto annuli = geometric_annuli(options.lattice_cell_m, kRatio, last_m);
    return lattice_structure_function(levelled(*options.lattice_m, mean(survey.z_m)), options.lattice_cell_m, annuli,
                                      executor);
  }
  const auto n = static_cast<double>(prepared.points.size());
  const double reach = last_m / spacing_m;
  const double pairs = 0.5 * n * std::min(n, std::numbers::pi * reach * reach);
  route = pairs <= kMostPairs ? PairRoute::near_pairs : PairRoute::thinned;
  PairOptions pair_options;
  pair_options.route = route;
  pair_options.spacing_m = spacing_m;
  pair_options.seed = options.seed;
  return structure_function(columns_of(prepared), geometric_annuli(0.5 * spacing_m, kRatio, last_m), pair_options,
                            executor);
}

DimensionEstimate describe(const LogLogDimension& fit, const VecchiaPoints& prepared, const MomentOptions& options) {
  DimensionEstimate out;
  if (fit.dimension >= 2.0 && fit.dimension <= 3.0) out.dimension = fit.dimension, out.amplitude_m = fit.amplitude_m;
  out.method = options.moment == Moment::first_absolute ? "yokoya" : "pentland";
  out.points = prepared.points.size();
  out.duplicates = prepared.duplicates;
  out.spacing_m = prepared.spacing_m;
  out.flags = static_cast<std::uint16_t>(kOpenBelow | kOpenAbove);
  if (prepared.duplicates > 0) out.flags |= kDuplicatesMerged;
  return out;
}

void set_interval(double sigma, DimensionEstimate& out) {
  constexpr double kNormal95 = 1.96;
  out.sigma = sigma;
  const double low = out.dimension - kNormal95 * sigma, high = out.dimension + kNormal95 * sigma;
  out.interval95 = {std::max(low, 2.0), std::min(high, 3.0)};
  if (low > 2.0) out.flags &= static_cast<std::uint16_t>(~kOpenBelow);
  if (high < 3.0) out.flags &= static_cast<std::uint16_t>(~kOpenAbove);
}

}  // namespace

Result<MomentDimension> estimate_dimension_moment(const SurveyPoints& survey, const MomentOptions& options,
                                                  Executor& executor) {
  if (!(options.max_lag_m >= 0.0 && std::isfinite(options.max_lag_m)))
    return Error{ErrorKind::usage,
                 fmt::format("longest lag: expected metres of at least 0 (0: chosen), found {}", options.max_lag_m)};
  const auto prepared = prepare_points(survey);
  if (!prepared) return prepared.error();
  const double spacing_m = prepared->spacing_m;
  const auto count = static_cast<double>(prepared->points.size());
  const double last_m = longest_lag(spacing_m, spacing_m * std::sqrt(count), options.max_lag_m);
  const double first_m = fits_lattice(options, last_m) ? options.lattice_cell_m : 0.5 * spacing_m;
  if (last_m < 2.0 * first_m)
    return Error{ErrorKind::bad_data,
                 fmt::format("longest lag: expected at least {:.3g} m for points {:.3g} m apart, found {:.3g} m",
                             2.0 * first_m, spacing_m, last_m)};
  MomentDimension out;
  const auto sums = pair_sums(survey, *prepared, options, last_m, executor, out.route);
  if (!sums) return sums.error();
  const double enough = std::clamp(count / 4.0, 5.0, 30.0);
  out.points = log_log_points(*sums, options.moment, enough);
  if (out.points.size() < kLeastAnnuli)
    return Error{ErrorKind::bad_data,
                 fmt::format("log-log plot: expected at least {} distances with {:.3g} pairs or more, up to {:.3g} m, "
                             "found {}",
                             kLeastAnnuli, enough, last_m, out.points.size())};
  auto fit = log_log_dimension(out.points, options.moment, options.segmentation, options.tolerance);
  if (!fit) return fit.error();
  out.fit = *std::move(fit);
  out.estimate = describe(out.fit, *prepared, options);
  if (out.route == PairRoute::lattice) out.estimate.points = known_cells(*options.lattice_m);
  if (!std::isfinite(out.estimate.dimension)) return out;
  if (const auto sigma = moment_sigma(survey, out, options, executor)) set_interval(*sigma, out.estimate);
  return out;
}

}  // namespace scree::fractal
