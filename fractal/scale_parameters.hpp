#pragma once
// Free parameters of the four laws, and where to start looking for them.

#include <Eigen/Core>
#include <vector>

#include "fractal/ground_law.hpp"
#include "fractal/lag_statistics.hpp"
#include "fractal/scale_laws.hpp"

namespace scree::fractal {

/// Maps unbounded parameters to a law: logarithms of mean-square changes at a distance in the middle of the data,
/// where they depend on each other least, and logits of H within (.005, .995). Natural units (spacings).
class ScaleParameters {
 public:
  ScaleParameters(ScaleLaw law, const LagStatistics& statistics);

  int count() const;
  GroundLaw ground(const Eigen::VectorXd& parameters) const;
  static double hurst(double logit);
  static double logit(double hurst);  ///< its inverse within .007 … .993, the nearest of these outside
  static constexpr int kHurst = 1;    ///< index of the logit of the shortest scale's H
  /// Slopes of thirds of the plot, turning points spread over it.
  std::vector<Eigen::VectorXd> starts() const;

 private:
  double slope(double from, double to) const;  ///< H by the points in that share of the plot
  ScaleLaw law_;
  const LagStatistics& statistics_;
  double middle_;  ///< distance
};

}  // namespace scree::fractal
