#include "fractal/law_picture.hpp"

#include <cmath>

#include "fractal/lag_covariance.hpp"

namespace scree::fractal {
namespace {

/// In the units of `statistics`.
GroundLaw ground_of(const DimensionEstimate& law, const LagStatistics& statistics) {
  GroundLaw ground;
  ground.first.hurst = 3.0 - law.dimension;
  const double change_m = law.amplitude_m * std::pow(statistics.spacing_m, ground.first.hurst);
  ground.first.square = change_m * change_m / (statistics.height_m * statistics.height_m);
  ground.noise_variance = statistics.noise_variance;
  ground.blur = statistics.blur;
  return ground;
}

}  // namespace

Result<LawPicture> law_picture(const SurveyPoints& survey, const StructureDimensionOptions& options,
                               const DimensionEstimate& law, const DimensionEstimate* other, Executor& executor) {
  const auto statistics = lag_statistics(survey, {options.max_lag_m, options.seed}, executor);
  if (!statistics) return statistics.error();
  const LagModel model(*statistics);
  const GroundLaw ground = ground_of(law, *statistics);
  const Eigen::VectorXd expected = model.expected(ground);
  Eigen::VectorXd expected_other;
  if (other != nullptr) expected_other = model.expected(ground_of(*other, *statistics));
  LawPicture out;
  const double log_unit = std::log(statistics->height_m);
  for (Eigen::Index l = 0; l < expected.size(); ++l) {
    const Lag& lag = statistics->lags[static_cast<std::size_t>(l)];
    const double total = ground.variogram(lag.distance) + 2.0 * (ground.noise_variance + statistics->slope_noise);
    const double restored = std::log(total / expected[l]);
    out.points.push_back(
        {std::log(lag.distance * statistics->spacing_m), 0.5 * (lag.log_square + restored) + log_unit, lag.pairs});
    if (other != nullptr) out.log_other.push_back(0.5 * (std::log(expected_other[l]) + restored) + log_unit);
  }
  return out;
}

}  // namespace scree::fractal
