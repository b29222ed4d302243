#pragma once
// Nonlinear least squares in a few parameters.

#include <Eigen/Core>
#include <functional>

namespace scree::fractal {

struct LeastSquares {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd jacobian;  ///< of the residuals there
  double cost = 0.0;         ///< Σ residual²
};

/// Levenberg–Marquardt with forward differences of 1e-5; ends where a step gains less than 1e-6, or after 60 of them.
/// Parameters of order one. Cost: (parameters + 1) evaluations a step.
LeastSquares minimise(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residuals, Eigen::VectorXd start);

}  // namespace scree::fractal
