#include "fractal/plane_loss.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::fractal {
namespace {

constexpr Eigen::Index kDistances = 72;
constexpr double kRange = 600.0;       // longest over shortest distance
constexpr double kWidth = 0.15;        // of the smoothing over distance, nepers
constexpr double kEnoughPairs = 1000;  // of the sample in an annulus

/// Two points of the sample, and where their distance lies among the evenly spaced logarithms.
struct SamplePair {
  Eigen::Index i, j;
  double log_distance;
  Eigen::Index first;         // of four distances around it
  Eigen::RowVector4d shares;  // cubic interpolation: ground that is nearly a plane is nearly all taken
  double weight;              // pairs it stands for
};

/// Lagrange weights of the values at 0, 1, 2, 3 for the value at t.
Eigen::RowVector4d cubic(double t) {
  const double a = t, b = t - 1.0, c = t - 2.0, d = t - 3.0;
  return {-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0};
}

std::vector<SamplePair> pairs_of(const Eigen::MatrixX2d& sample, const Eigen::VectorXd& weights, double shortest,
                                 double step) {
  std::vector<SamplePair> pairs;
  pairs.reserve(static_cast<std::size_t>(sample.rows() * (sample.rows() - 1) / 2));
  for (Eigen::Index i = 0; i < sample.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double d = (sample.row(i) - sample.row(j)).norm();
      if (!(d > 0.0)) continue;
      const double at = std::max(0.0, (std::log(d) - std::log(shortest)) / step);
      const auto first = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(at) - 1, 0, kDistances - 4);
      pairs.push_back({i, j, std::log(d), first, cubic(at - static_cast<double>(first)), weights[i] * weights[j]});
    }
  return pairs;
}

/// What the sample says for one distance: the mean over pairs of q_i − q_k, by point, and of u uᵀ. What the plane takes
/// is nearly quadratic in the distance, so pairs about as far apart serve as well, scaled: without kinks between lags.
struct Annulus {
  Eigen::MatrixX2d partners;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double pairs = 0.0;  ///< of the sample

  Annulus(const Eigen::MatrixX2d& sample, const std::vector<SamplePair>& all, double log_lag)
      : partners(Eigen::MatrixX2d::Zero(sample.rows(), 2)) {
    for (const SamplePair& pair : all) {
      const double off = (pair.log_distance - log_lag) / kWidth;
      if (std::abs(off) > 3.0) continue;
      const double kernel = std::exp(-0.5 * off * off), weight = kernel * pair.weight;
      const Eigen::RowVector2d u = sample.row(pair.i) - sample.row(pair.j);
      partners.row(pair.i) += weight * u;
      partners.row(pair.j) -= weight * u;
      spread += weight * u.transpose() * u;
      pairs += kernel;
    }
    const double share = spread.trace() > 0.0 ? std::exp(2.0 * log_lag) / spread.trace() : 0.0;
    partners *= share;
    spread *= share;
  }
};

/// Weights of γ at the distances between all points of the sample.
Eigen::RowVectorXd loss_of(const Eigen::MatrixX2d& slope_weights, const std::vector<SamplePair>& all,
                           const Annulus& annulus) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(kDistances);
  const Eigen::MatrixX2d turned = slope_weights * annulus.spread;
  for (const SamplePair& pair : all) {
    const double cross = slope_weights.row(pair.j).dot(annulus.partners.row(pair.i)) +
                         slope_weights.row(pair.i).dot(annulus.partners.row(pair.j));
    const double weight = cross - turned.row(pair.i).dot(slope_weights.row(pair.j));
    row.segment<4>(pair.first) += weight * pair.shares;
  }
  return row;
}

}  // namespace

PlaneLoss::PlaneLoss(const LagStatistics& statistics) {
  const auto& sample = statistics.sample;
  const Eigen::RowVector2d extent = sample.colwise().maxCoeff() - sample.colwise().minCoeff();
  const double longest = extent.norm(), step = std::log(kRange) / static_cast<double>(kDistances - 1);
  distances.resize(kDistances);
  for (Eigen::Index i = 0; i < kDistances; ++i)
    distances[i] = longest / kRange * std::exp(step * static_cast<double>(i));
  const auto pairs = pairs_of(sample, statistics.sample_weights, distances[0], step);
  const auto& stand_for = statistics.sample_weights;
  const Eigen::RowVector2d mean = stand_for.transpose() * sample / stand_for.sum();
  const Eigen::MatrixX2d centred = sample.rowwise() - mean;
  const Eigen::MatrixX2d weighted = stand_for.asDiagonal() * centred;
  const Eigen::MatrixX2d slope_weights = weighted * (centred.transpose() * weighted).inverse();

  slope = Eigen::VectorXd::Zero(kDistances);
  for (const SamplePair& pair : pairs) {
    const double weight = -slope_weights.row(pair.i).dot(slope_weights.row(pair.j));
    slope.segment<4>(pair.first) += weight * pair.shares.transpose();
  }
  const auto lags = static_cast<Eigen::Index>(statistics.lags.size());
  weights = Eigen::MatrixXd::Zero(lags, kDistances);
  double source_log_lag = 0.0;
  Eigen::Index source = -1;  // the lag whose weights, scaled, serve the ones below
  for (Eigen::Index l = lags - 1; l >= 0; --l) {
    // the mean square of the distances in the annulus
    const Lag& lag = statistics.lags[static_cast<std::size_t>(l)];
    const double log_lag = std::log(lag.distance) + lag.spread * lag.spread;
    if (const Annulus annulus(sample, pairs, log_lag); source < 0 || annulus.pairs >= kEnoughPairs) {
      weights.row(l) = loss_of(slope_weights, pairs, annulus);
      source = l, source_log_lag = log_lag;
      continue;
    }
    // Over short lags the loss is that of a mean-square slope.
    weights.row(l) = std::exp(2.0 * (log_lag - source_log_lag)) * weights.row(source);
  }
}

}  // namespace scree::fractal
