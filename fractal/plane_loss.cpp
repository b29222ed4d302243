#include "fractal/plane_loss.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::fractal {
namespace {

constexpr Eigen::Index kDistances = 72;
constexpr double kRange = 600.0;      // longest over shortest distance
constexpr double kEnoughPairs = 200;  // of the sample in an annulus

/// Two points of the sample, and where their distance lies among the evenly spaced logarithms.
struct SamplePair {
  Eigen::Index i, j;
  double distance;
  Eigen::Index below;
  double share;  // of the distance above
};

std::vector<SamplePair> pairs_of(const Eigen::MatrixX2d& sample, double shortest, double step) {
  std::vector<SamplePair> pairs;
  pairs.reserve(static_cast<std::size_t>(sample.rows() * (sample.rows() - 1) / 2));
  for (Eigen::Index i = 0; i < sample.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double d = (sample.row(i) - sample.row(j)).norm();
      if (!(d > 0.0)) continue;
      const double at = std::clamp(std::log(d / shortest) / step, 0.0, static_cast<double>(kDistances - 1) - 1e-9);
      const auto below = static_cast<Eigen::Index>(at);
      pairs.push_back({i, j, d, below, at - static_cast<double>(below)});
    }
  return pairs;
}

/// What the sample says for one annulus: the mean over its pairs of q_i − q_k, by point, and of u uᵀ.
struct Annulus {
  Eigen::MatrixX2d partners;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double pairs = 0.0;

  Annulus(const Eigen::MatrixX2d& sample, const std::vector<SamplePair>& all, const Lag& lag)
      : partners(Eigen::MatrixX2d::Zero(sample.rows(), 2)) {
    for (const SamplePair& pair : all) {
      if (pair.distance < lag.inner || pair.distance >= lag.outer) continue;
      const Eigen::RowVector2d u = sample.row(pair.i) - sample.row(pair.j);
      partners.row(pair.i) += u;
      partners.row(pair.j) -= u;
      spread += u.transpose() * u;
      pairs += 1.0;
    }
    const double share = 1.0 / std::max(pairs, 1.0);
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
    row[pair.below] += (1.0 - pair.share) * weight;
    row[pair.below + 1] += pair.share * weight;
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
  const auto pairs = pairs_of(sample, distances[0], step);
  const Eigen::MatrixX2d centred = sample.rowwise() - sample.colwise().mean();
  const Eigen::MatrixX2d slope_weights = centred * (centred.transpose() * centred).inverse();

  slope = Eigen::VectorXd::Zero(kDistances);
  for (const SamplePair& pair : pairs) {
    const double weight = -slope_weights.row(pair.i).dot(slope_weights.row(pair.j));
    slope[pair.below] += (1.0 - pair.share) * weight;
    slope[pair.below + 1] += pair.share * weight;
  }
  const auto lags = static_cast<Eigen::Index>(statistics.lags.size());
  weights = Eigen::MatrixXd::Zero(lags, kDistances);
  Eigen::Index source = -1;  // the lag whose weights, scaled, serve the ones below
  for (Eigen::Index l = lags - 1; l >= 0; --l) {
    const Lag& lag = statistics.lags[static_cast<std::size_t>(l)];
    if (const Annulus annulus(sample, pairs, lag); source < 0 || annulus.pairs >= kEnoughPairs) {
      weights.row(l) = loss_of(slope_weights, pairs, annulus);
      source = l;
      continue;
    }
    // Over short lags the loss is that of a mean-square slope.
    const double ratio = lag.distance / statistics.lags[static_cast<std::size_t>(source)].distance;
    weights.row(l) = ratio * ratio * weights.row(source);
  }
}

}  // namespace scree::fractal
