#include "fractal/contrast_test.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "fractal/increment_covariance.hpp"

namespace scree::fractal {
namespace {

/// Covariance of the mean squares of two classes times n_a·n_b/2.
double covariance_sum(const DirectedEnergies& energies, const IncrementKernel& kernel, const IsotropicLaw& law, int a,
                      int b) {
  const auto increment = [](int i) { return kDirectedSteps[static_cast<std::size_t>(i)].increment(); };
  const auto& first = energies.complete[static_cast<std::size_t>(a)];
  const auto& second = energies.complete[static_cast<std::size_t>(b)];
  const IncrementPair pair(increment(a), increment(b));
  const std::vector<double> counts = pair_counts(first, second, kCorrelationReach);
  double sum = 0.0;
  auto count = counts.begin();
  for (int oy = -kCorrelationReach; oy <= kCorrelationReach; ++oy)
    for (int ox = -kCorrelationReach; ox <= kCorrelationReach; ++ox) {
      const IncrementCovariance at = pair.covariance(kernel, ox, oy);
      const double covariance = law.c_m2 * at.signal + law.noise_m2 * at.noise;
      sum += *count++ * covariance * covariance;
    }
  return sum;
}

struct Variances {
  std::array<double, kDirectedCount> total, signal;
};
Variances variances(const IncrementKernel& kernel, const IsotropicLaw& law) {
  Variances out{};
  for (std::size_t i = 0; i < kDirectedSteps.size(); ++i) {
    const Increment increment = kDirectedSteps[i].increment();
    const IncrementCovariance at = IncrementPair(increment, increment).covariance(kernel, 0, 0);
    out.signal[i] = law.c_m2 * at.signal;
    out.total[i] = out.signal[i] + law.noise_m2 * at.noise;
  }
  return out;
}

DirectedMatrix log_covariance(const DirectedEnergies& energies, const IncrementKernel& kernel, const IsotropicLaw& law,
                              const Variances& variance, Executor& executor) {
  DirectedMatrix out;
  executor.for_ranges(kDirectedCount, [&](int begin, int end) {
    for (int a = begin; a < end; ++a)
      for (int b = 0; b <= a; ++b) {
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
        out(a, b) = out(b, a) = 2.0 * covariance_sum(energies, kernel, law, a, b) /
                                (energies.count[i] * energies.count[j] * variance.total[i] * variance.total[j]);
      }
  });
  return out;
}

}  // namespace

ContrastMatrix contrast_covariance(const DirectedMatrix& log_covariance) {
  Eigen::Matrix<double, kContrastCount, kDirectedCount> difference = decltype(difference)::Zero();
  for (int i = 0; i < kContrastCount; ++i) {
    difference(i, 2 * i) = 1.0;
    difference(i, 2 * i + 1) = -1.0;
  }
  return difference * log_covariance * difference.transpose();
}

ContrastTest test_contrasts(const DirectedEnergies& energies, const IsotropicLaw& law, Executor& executor) {
  const IncrementKernel kernel(law.support, law.hurst);
  const Variances variance = variances(kernel, law);
  const ContrastMatrix sigma = contrast_covariance(log_covariance(energies, kernel, law, variance, executor));
  ContrastTest out;
  for (int i = 0; i < kContrastCount; ++i) {
    const auto a = static_cast<std::size_t>(2 * i), b = a + 1;
    out.contrast(i) = std::log(energies.mean_square_m2[a] / energies.mean_square_m2[b]);
  }
  const ContrastMatrix weight = sigma.inverse();
  out.chi_square = out.contrast.dot(weight * out.contrast);
  // A stretch gives the same contrast at either step; noise, the same in all directions, dilutes it.
  Eigen::Matrix<double, kContrastCount, 2> seen;
  seen << 1, 0, 0, 1, 1, 0, 0, 1;
  for (int i = 0; i < kContrastCount; ++i)
    seen.row(i) *= variance.signal[static_cast<std::size_t>(2 * i)] / variance.total[static_cast<std::size_t>(2 * i)];
  out.signal_contrast = (seen.transpose() * weight * seen).inverse() * (seen.transpose() * weight * out.contrast);
  return out;
}

}  // namespace scree::fractal
