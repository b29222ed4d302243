#include "fractal/lag_covariance.hpp"

#include "composite_surfaces.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace scree::fractal {
namespace {

/// Errors of ln S against the law it was drawn from.
struct Errors {
  Eigen::ArrayXd mean_ratio, ratio_error;     ///< of S to its expectation, and the standard error
  Eigen::ArrayXd deviation, theory;           ///< of ln S
  Eigen::ArrayXd expected, without_the_loss;  ///< E S of the last surface
};

Errors errors_over(int surfaces, double hurst) {
  SerialExecutor serial;
  Eigen::ArrayXd sum, sum2, log_sum, log_sum2;
  Errors out;
  for (int k = 0; k < surfaces; ++k) {
    const Raster raster = composite_raster({ScaleLaw::power, hurst}, 64, static_cast<std::uint64_t>(k));
    const auto statistics = *lag_statistics(raster.survey(), {}, serial);
    const LagModel model(statistics);
    const double change = std::pow(statistics.spacing_m, hurst) / statistics.height_m;
    const GroundLaw law{{change * change, hurst}, {}, 0.0, 0.0, 0.0};
    out.expected = model.expected(law);
    Eigen::ArrayXd log_ratio(out.expected.size());
    out.without_the_loss = log_ratio;
    for (Eigen::Index l = 0; l < log_ratio.size(); ++l) {
      const Lag& lag = statistics.lags[static_cast<std::size_t>(l)];
      log_ratio[l] = lag.log_square - std::log(out.expected[l]);
      out.without_the_loss[l] = law.variogram(lag.distance);
    }
    if (k == 0) sum = sum2 = log_sum = log_sum2 = Eigen::ArrayXd::Zero(log_ratio.size());
    if (k == 0) out.theory = model.covariance(law).diagonal().cwiseSqrt();
    const Eigen::ArrayXd ratio = log_ratio.exp();
    sum += ratio, sum2 += ratio.square(), log_sum += log_ratio, log_sum2 += log_ratio.square();
  }
  out.mean_ratio = sum / surfaces;
  out.ratio_error = ((sum2 / surfaces - out.mean_ratio.square()) / (surfaces - 1)).sqrt();
  out.deviation = ((log_sum2 - log_sum.square() / surfaces) / (surfaces - 1)).sqrt();
  return out;
}

// n = 80 surfaces of 64² a row. Means: 4 standard errors (false alarms 1e-4, lags are correlated) and 1 % for the
// finite sample of places. Deviations: 25 % for the theory of endless surveys at this size and 4 standard errors,
// 1/√158.
TEST(LagModel, FollowsFromTheLawOfTheGround) {
  for (const double hurst : {0.25, 0.5, 0.7}) {
    const Errors found = errors_over(80, hurst);
    for (Eigen::Index l = 0; l < found.mean_ratio.size(); ++l) {
      EXPECT_NEAR(found.mean_ratio[l], 1.0, 4.0 * found.ratio_error[l] + 0.01) << hurst << " lag " << l;
      EXPECT_NEAR(found.deviation[l] / found.theory[l], 1.0, 0.25 + 4.0 / std::sqrt(158.0)) << hurst << " lag " << l;
    }
    // The plane takes more than sampling errors of the longest lag could hide.
    const Eigen::Index last = found.expected.size() - 1;
    if (hurst > 0.6) {
      EXPECT_LT(found.expected[last], 0.8 * found.without_the_loss[last]);
    }
  }
}

TEST(LagModel, PlanesAreTakenWhole) {
  SerialExecutor serial;
  const Raster raster = composite_raster({ScaleLaw::power, 0.5}, 64, 3);
  const auto statistics = *lag_statistics(raster.survey(), {}, serial);
  const PlaneLoss loss(statistics);
  // γ = d² is that of a plane of random slope: nothing is left of it
  const Eigen::VectorXd left = loss.weights * loss.distances.cwiseAbs2();
  for (std::size_t l = 0; l < statistics.lags.size(); ++l) {
    const double square = std::pow(statistics.lags[l].distance, 2.0) * std::cosh(2.0 * statistics.lags[l].spread);
    EXPECT_NEAR(left[static_cast<Eigen::Index>(l)] / square, -1.0, 1e-3);
  }
  EXPECT_NEAR(loss.slope.dot(loss.distances.cwiseAbs2()), 2.0, 2e-3);  // E|b|² of unit slope along x and y
}

}  // namespace
}  // namespace scree::fractal
