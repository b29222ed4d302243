#include "fractal/moment_interval.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/lag_covariance.hpp"

namespace scree::fractal {
namespace {

/// Thinning leaves a share of them.
double points_at(double distance, const MomentDimension& found) {
  const auto all = static_cast<double>(found.estimate.points);
  if (found.route != PairRoute::thinned) return all;
  const double octave = std::max(0.0, std::floor(std::log2(distance)));
  return all * std::min(1.0, PairOptions{}.thinning_density * std::exp2(-2.0 * octave));
}

/// The annuli of the line, in the units of `statistics`.
std::vector<Lag> lags_of(const MomentDimension& found, const LagStatistics& statistics) {
  std::vector<Lag> lags;
  const LogLogSegment* used = nullptr;
  for (const auto& segment : found.fit.segments)
    if (segment.last - segment.first >= 2) {
      used = &segment;
      break;
    }
  if (used == nullptr) return lags;
  for (int i = used->first; i <= used->last; ++i) {
    const LogLogPoint& p = found.points[static_cast<std::size_t>(i)];
    const double distance = std::exp(p.log_lag) / statistics.spacing_m;
    const double half = std::exp2(0.125);  // annuli are a fourth of an octave wide
    lags.push_back({.inner = distance / half,
                    .outer = distance * half,
                    .distance = distance,
                    .log_square = 2.0 * p.log_change,
                    .pairs = p.pairs,
                    .points = points_at(distance, found)});
  }
  return lags;
}

}  // namespace

Result<double> moment_sigma(const SurveyPoints& survey, const MomentDimension& found, const MomentOptions& options,
                            Executor& executor) {
  auto statistics = lag_statistics(survey, {options.max_lag_m, options.seed}, executor);
  if (!statistics) return statistics.error();
  statistics->lags = lags_of(found, *statistics);
  const LagModel model(*statistics);
  GroundLaw law;
  law.first.hurst = std::clamp(3.0 - found.estimate.dimension, 0.02, 0.97);
  const double change_m = found.estimate.amplitude_m * std::pow(statistics->spacing_m, law.first.hurst);
  law.first.square = change_m * change_m / (statistics->height_m * statistics->height_m);
  const Eigen::MatrixXd covariance = model.covariance(law);
  const auto count = static_cast<Eigen::Index>(statistics->lags.size());
  Eigen::VectorXd weights(count);
  for (Eigen::Index i = 0; i < count; ++i)
    weights[i] = std::log(statistics->lags[static_cast<std::size_t>(i)].distance);
  weights.array() -= weights.mean();
  weights /= weights.squaredNorm();
  return 0.5 * std::sqrt(std::max(0.0, weights.dot(covariance * weights)));
}

}  // namespace scree::fractal
