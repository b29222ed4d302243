#pragma once
// Generalised least squares on the logarithms of a structure function.

#include <Eigen/Cholesky>

#include "fractal/lag_covariance.hpp"

namespace scree::fractal {

/// Residuals ln S − ln E S in units in which their covariance, under a law chosen beforehand, is the identity.
class LagFit {
 public:
  explicit LagFit(const LagStatistics& statistics);

  /// Weights from the covariance under `law`, each variance .02 % larger against what the theory leaves out (1 % more
  /// with horizontal noise of a spacing or more); the same covariance corrects for E ln S < ln E S.
  void weigh(const LagModel& model, const GroundLaw& law);
  Eigen::VectorXd whitened(const Eigen::VectorXd& values) const { return root_.matrixL().solve(values); }
  /// `log_expected`: ln E S_l of a model.
  Eigen::VectorXd residual(const Eigen::VectorXd& log_expected) const { return whitened(observed_ - log_expected); }

 private:
  double blur_;
  Eigen::VectorXd log_square_, observed_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

}  // namespace scree::fractal
