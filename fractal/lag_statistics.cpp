#include "fractal/lag_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "fractal/structure_function.hpp"
#include "fractal/vecchia_points.hpp"

namespace scree::fractal {
namespace {

constexpr int kAnnuli = 20;
constexpr double kLongest = 0.225;         // of the side
constexpr double kShortest = 0.25;         // spacings, scattered points
constexpr double kMostPairs = 4e7;         // a twentieth of a second
constexpr double kMostLatticeCells = 8e6;  // .4 GB of transforms
constexpr double kThinningDensity = 8.0;
constexpr double kLeastPairs = 20.0;
constexpr std::size_t kLeastAnnuli = 4;
constexpr int kSampleSquares = 24;  // along an axis

Error bad(std::string message) {
  return {ErrorKind::bad_data, "structure function: " + std::move(message)};
}

/// Pitch of the values if they lie on a line of evenly spaced ones, else 0.
double pitch_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double extent = values.back() - values.front(), tolerance = 1e-6 * extent;
  double least = extent;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (const double step = values[i] - values[i - 1]; step > tolerance) least = std::min(least, step);
  if (!(least > 0.0)) return 0.0;
  const double pitch = extent / std::round(extent / least);
  for (const double value : values) {
    const double cells = (value - values.front()) / pitch;
    if (std::abs(cells - std::round(cells)) > 0.01) return 0.0;
  }
  return pitch;
}

/// Pitch of the square lattice that at least a quarter of is known, else 0.
double lattice_cell(const std::vector<VecchiaPoint>& points) {
  std::vector<double> x, y;
  for (const auto& p : points) x.push_back(p.x), y.push_back(p.y);
  const auto [x0, x1] = std::minmax_element(x.begin(), x.end());
  const auto [y0, y1] = std::minmax_element(y.begin(), y.end());
  const double width = *x1 - *x0, height = *y1 - *y0;
  const double dx = pitch_of(std::move(x)), dy = pitch_of(std::move(y));
  if (!(dx > 0.0 && dy > 0.0) || std::abs(dx - dy) > 1e-3 * dx) return 0.0;
  const double cells = (width / dx + 1.0) * (height / dy + 1.0);
  return cells > 4.0 * static_cast<double>(points.size()) || cells > kMostLatticeCells ? 0.0 : 0.5 * (dx + dy);
}

Annuli annuli_for(double shortest, double longest) {
  const double ratio = std::clamp(std::pow(longest / shortest, 1.0 / (kAnnuli - 1)), 1.12, 1.6);
  return geometric_annuli(shortest, ratio, longest * (1.0 + 1e-9));
}

PointColumns columns_of(const std::vector<VecchiaPoint>& points) {
  PointColumns columns;
  columns.reserve(points.size());
  for (const auto& p : points)
    columns.push_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
  return columns;
}

/// The route that is fast enough, and how many points it looks at for a distance (spacings).
struct Route {
  PairOptions options;
  double points = 0.0;
  double points_at(double distance) const {
    if (options.route != PairRoute::thinned) return points;
    const double octave = std::max(0.0, std::floor(std::log2(distance) + 1e-9));
    return points * std::min(1.0, options.thinning_density * std::pow(4.0, -octave));
  }
};

Route route_for(double points, double cell, double longest, std::uint64_t seed) {
  Route route;
  route.points = points;
  route.options.seed = seed;
  if (cell > 0.0)
    route.options.route = PairRoute::lattice, route.options.spacing_m = cell;
  else if (1.6 * points * longest * longest < kMostPairs)
    route.options.route = PairRoute::near_pairs;
  else
    route.options.route = PairRoute::thinned, route.options.spacing_m = 1.0,
    route.options.thinning_density = kThinningDensity;
  return route;
}

/// The first point in each square of the bounding box; their order is random.
void take_sample(const std::vector<VecchiaPoint>& points, LagStatistics& out) {
  const auto [x0, x1] = std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [y0, y1] = std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y < b.y; });
  const double square = std::max(x1->x - x0->x, y1->y - y0->y) / (kSampleSquares - 1e-6);
  std::vector<const VecchiaPoint*> first(kSampleSquares * kSampleSquares);
  std::vector<double> counts(first.size());
  for (const auto& p : points) {
    const auto row = static_cast<std::size_t>((p.y - y0->y) / square),
               column = static_cast<std::size_t>((p.x - x0->x) / square);
    const std::size_t at = row * kSampleSquares + column;
    if (first[at] == nullptr) first[at] = &p;
    counts[at] += 1.0;
  }
  const auto taken = static_cast<Eigen::Index>(first.size()) - std::count(first.begin(), first.end(), nullptr);
  out.sample.resize(taken, 2);
  out.sample_weights.resize(taken);
  for (Eigen::Index i = 0, at = 0; i < taken; ++at) {
    const auto square_at = static_cast<std::size_t>(at);
    if (first[square_at] == nullptr) continue;
    out.sample.row(i) << first[square_at]->x, first[square_at]->y;
    out.sample_weights[i++] = counts[square_at];
  }
}

/// Standard deviation of log distances in an annulus: evenly filled, or by the offsets of a lattice.
double spread_of(double inner, double outer, double cell) {
  if (cell <= 0.0 || outer > 40.0 * cell) return std::log(outer / inner) / std::sqrt(12.0);
  double count = 0.0, sum = 0.0, sum2 = 0.0;
  const int reach = static_cast<int>(outer / cell) + 1;
  for (int y = 0; y <= reach; ++y)
    for (int x = 1; x <= reach; ++x) {
      const double d = cell * std::hypot(x, y);
      if (d < inner || d >= outer) continue;
      count += 1.0, sum += std::log(d), sum2 += std::log(d) * std::log(d);
    }
  return count > 0.0 ? std::sqrt(std::max(0.0, sum2 / count - sum * sum / (count * count))) : 0.0;
}

/// Share of a cell's nearest lattice neighbours that are known.
double lattice_fill(const Lag& first, double points, double cell) {
  int neighbours = 0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      const double d = cell * std::hypot(x, y);
      if (d >= first.inner && d < first.outer) ++neighbours;
    }
  return neighbours > 0 ? std::min(1.0, 2.0 * first.pairs / (points * neighbours)) : 1.0;
}

void gather(const StructureFunction& sums, const Route& route, LagStatistics& out) {
  for (int i = 0; i < sums.annuli.count; ++i) {
    const PairSums& sum = sums.sums[static_cast<std::size_t>(i)];
    if (sum.count < kLeastPairs || !(sum.square_m2 > 0.0)) continue;
    const double inner = sums.annuli.inner_m(i), outer = sums.annuli.outer_m(i);
    out.lags.push_back({inner, outer, std::exp(sum.log_m / sum.count), spread_of(inner, outer, out.cell),
                        std::log(sum.square_m2 / sum.count), sum.count, route.points_at(sums.annuli.distance_m(i))});
  }
}

}  // namespace

Result<LagStatistics> lag_statistics(const SurveyPoints& survey, const LagOptions& options, Executor& executor) {
  if (!(options.max_lag_m >= 0.0 && std::isfinite(options.max_lag_m)))
    return bad(fmt::format("expected a finite longest lag >= 0 (0 = from the points), found {} m", options.max_lag_m));
  const auto prepared = prepare_points(survey);
  if (!prepared) return prepared.error();
  const auto& points = prepared->points;
  LagStatistics out;
  out.spacing_m = prepared->spacing_m;
  out.height_m = prepared->height_m;
  out.noise_variance = std::pow(survey.noise_sigma_m / out.height_m, 2.0);
  out.slope_noise = std::max(0.0, prepared->noise_variance - out.noise_variance);
  out.blur = survey.noise_xy_sigma_m / out.spacing_m;
  out.points = points.size();
  out.duplicates = prepared->duplicates;
  const auto count = static_cast<double>(points.size());
  out.cell = lattice_cell(points);
  out.side = std::sqrt(count) * (out.cell > 0.0 ? out.cell : 1.0);
  const double longest = options.max_lag_m > 0.0 ? options.max_lag_m / out.spacing_m
                                                 : std::min(0.45 * out.side, std::max(kLongest * out.side, 2.5));
  const double shortest = out.cell > 0.0 ? out.cell : kShortest;
  if (!(longest > shortest))
    return bad(fmt::format("expected a longest lag beyond {:.3g} m, found {:.3g} m", shortest * out.spacing_m,
                           longest * out.spacing_m));
  const Route route = route_for(count, out.cell, longest, options.seed);
  const auto sums = structure_function(columns_of(points), annuli_for(shortest, longest), route.options, executor);
  if (!sums) return sums.error();
  gather(*sums, route, out);
  if (out.lags.size() < kLeastAnnuli)
    return bad(fmt::format("expected at least {} distances with {} pairs or more, up to {:.3g} m, found {}",
                           kLeastAnnuli, kLeastPairs, longest * out.spacing_m, out.lags.size()));
  if (out.cell > 0.0) out.fill = lattice_fill(out.lags.front(), count, out.cell);
  if (out.fill > 0.0) out.side = out.cell * std::sqrt(count / out.fill);
  take_sample(points, out);
  return out;
}

}  // namespace scree::fractal
