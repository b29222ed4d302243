#include "fractal/dimension_tables.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "fractal/energy_covariance.hpp"

namespace scree::fractal {
namespace {

ClassVector signal_variances(Support support, double hurst) {
  const IncrementKernel kernel(support, hurst, IncrementKernel::kVarianceReach);
  ClassVector signal;
  for (int c = 0; c < kClassCount; ++c) {
    const Increment increment = kClasses[static_cast<std::size_t>(c)].increments().front();
    signal(c) = IncrementPair(increment, increment).covariance(kernel, 0, 0).signal;
  }
  return signal;
}

ClassVector noise_gains() {
  ClassVector gains;
  for (int c = 0; c < kClassCount; ++c) gains(c) = kClasses[static_cast<std::size_t>(c)].noise_gain();
  return gains;
}

struct Model {
  ClassVector signal, signal_slope;  ///< per unit of C, with the nugget κ·b·γ̄0/2; slope = d/dH
  EnergyCovariance covariance;
  double nugget = 0.0;  ///< κ·γ̄0/2
};

std::array<float, kClassCount> to_floats(const ClassVector& v) {
  std::array<float, kClassCount> result;
  for (int c = 0; c < kClassCount; ++c) result[static_cast<std::size_t>(c)] = static_cast<float>(v(c));
  return result;
}

/// Classes 0 and 2 are the axes at steps 1 and 2, 1 and 3 the diagonals.
void add_contrast_weight(ContrastMatrix sigma, const ClassVector& variance, DimensionTables& tables) {
  const auto v = variance.head<kContrastClassCount>();
  sigma.array() /= (v * v.transpose()).array();
  const auto block = [&](int i) {
    Eigen::Matrix2d pair;
    pair << sigma(i, i), sigma(i, i + 2), sigma(i, i + 2), sigma(i + 2, i + 2);
    const Eigen::Matrix2d weight = pair.inverse();
    return std::array<float, 3>{static_cast<float>(weight(0, 0)), static_cast<float>(weight(0, 1)),
                                static_cast<float>(weight(1, 1))};
  };
  tables.contrast_weights.push_back({block(0), block(1)});
}

void add_gains(const Model& model, double tau, double fill, DimensionTables& tables) {
  const ClassVector variance = model.signal + tau * noise_gains();
  ClassMatrix sigma = model.covariance.energies.at(model.nugget + tau, fill);
  sigma.array() /= (variance * variance.transpose()).array();
  sigma.diagonal() *= 1.01;  // the sum over offsets is cut, and the matrix nearly singular as H → 1
  const ClassMatrix weight = sigma.inverse();
  Eigen::Matrix<double, kClassCount, 2> slopes;
  slopes.col(0) =  // at constant E = C·signal_0(H)
      (model.signal_slope - model.signal * (model.signal_slope(0) / model.signal(0))).cwiseQuotient(variance);
  slopes.col(1) = model.signal.cwiseQuotient(variance);
  const Eigen::Matrix2d covariance = (slopes.transpose() * weight * slopes).inverse();
  const Eigen::Matrix<double, 2, kClassCount> gain = covariance * slopes.transpose() * weight;
  const ClassVector alone = weight * slopes.col(1) / slopes.col(1).dot(weight * slopes.col(1));
  tables.gains.push_back({to_floats(gain.row(0).transpose()), to_floats(gain.row(1).transpose()), to_floats(alone),
                          static_cast<float>(std::sqrt(covariance(0, 0)))});
  DimensionTables::Weight& out = tables.weights.emplace_back();
  for (int c = 0; c < kClassCount; ++c)
    for (int d = 0; d < kClassCount; ++d)
      out[static_cast<std::size_t>(c * kClassCount + d)] = static_cast<float>(weight(c, d));
  add_contrast_weight(model.covariance.contrasts.at(model.nugget + tau, fill), variance, tables);
}

Model make_model(Support support, double hurst, double share) {
  constexpr double kDelta = 1e-4;
  const auto nugget = [&](double h) { return 0.5 * share * mean_variogram(support, h, 0, 0); };
  const auto signal = [&](double h) -> ClassVector { return signal_variances(support, h) + nugget(h) * noise_gains(); };
  Model model;
  model.nugget = nugget(hurst);
  model.signal = signal(hurst);
  model.signal_slope = (signal(hurst + kDelta) - signal(hurst - kDelta)) / (2.0 * kDelta);
  return model;
}

/// See DimensionTables::max_hurst: where d log(energy_4/energy_1)/dH falls below a fifth of its noise-free 2·log 4.
float largest_tellable_hurst(const DimensionTables& tables, double share) {
  constexpr double kLeastSlope = 0.5;
  const auto log_ratio = [&](int node) {
    const auto& at = tables.variances[static_cast<std::size_t>(node)];
    const double rest = 1.0 - DimensionTables::hurst_of(node), nugget = share * at.half_gamma0 * 6.0;
    return std::log((rest * at.reduced_signal[4] + nugget) / (rest * at.reduced_signal[0] + nugget));
  };
  int node = DimensionTables::kVarianceNodes / 2;
  const double step = DimensionTables::hurst_of(1) - DimensionTables::hurst_of(0);
  while (node + 1 < DimensionTables::kVarianceNodes && log_ratio(node + 1) - log_ratio(node) > kLeastSlope * step)
    ++node;
  return static_cast<float>(DimensionTables::hurst_of(node));
}

DimensionTables build(Support support) {
  DimensionTables tables;
  tables.has_nugget = support == Support::block;
  for (int i = 0; i < DimensionTables::kVarianceNodes; ++i) {
    const double hurst = DimensionTables::hurst_of(i);
    tables.variances.push_back({to_floats(signal_variances(support, hurst) / (1.0 - hurst)),
                                static_cast<float>(0.5 * mean_variogram(support, hurst, 0, 0))});
  }
  std::vector<EnergyCovariance> covariances;
  for (int i = 0; i < DimensionTables::kHurstNodes; ++i)
    covariances.push_back(
        energy_covariance(IncrementKernel(support, DimensionTables::hurst_of(i * DimensionTables::kGainStride))));
  for (const double share : DimensionTables::kNuggets) {
    for (const double fill : DimensionTables::kFills)
      for (int i = 0; i < DimensionTables::kHurstNodes; ++i) {
        const double hurst = DimensionTables::hurst_of(i * DimensionTables::kGainStride);
        Model model = make_model(support, hurst, share);
        model.covariance = covariances[static_cast<std::size_t>(i)];
        for (int t = 0; t < DimensionTables::kNoiseNodes; ++t) {
          const double rho = DimensionTables::kMinNoise * std::exp(t * DimensionTables::kLogNoiseStep);
          add_gains(model, rho * model.signal(0), fill, tables);
        }
      }
    tables.max_hurst.push_back(tables.has_nugget ? largest_tellable_hurst(tables, share)
                                                 : static_cast<float>(kMaxHurst));
    if (!tables.has_nugget) break;
  }
  return tables;
}

}  // namespace

const DimensionTables& dimension_tables(Support support) {
  if (support == Support::centre_point) {
    static const DimensionTables points = build(Support::centre_point);
    return points;
  }
  static const DimensionTables blocks = build(Support::block);
  return blocks;
}

}  // namespace scree::fractal
