#include "fractal/least_squares.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr int kMaxSteps = 60;
constexpr double kDifference = 1e-5, kGain = 1e-6;
constexpr double kLongest = 2.0;  // largest change of a parameter in one step

}  // namespace

LeastSquares minimise(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residuals, Eigen::VectorXd start) {
  LeastSquares out{std::move(start), {}, 0.0};
  Eigen::VectorXd now = residuals(out.parameters);
  out.cost = now.squaredNorm();
  out.jacobian.resize(now.size(), out.parameters.size());
  double damping = 1e-3;
  for (int step = 0; step < kMaxSteps; ++step) {
    for (Eigen::Index k = 0; k < out.parameters.size(); ++k) {
      Eigen::VectorXd moved = out.parameters;
      moved[k] += kDifference;
      out.jacobian.col(k) = (residuals(moved) - now) / kDifference;
    }
    const Eigen::MatrixXd normal = out.jacobian.transpose() * out.jacobian;
    const Eigen::VectorXd gradient = out.jacobian.transpose() * now;
    double gain = -1.0;
    for (int attempt = 0; attempt < 12 && gain < 0.0; ++attempt) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * (normal.diagonal().array() + 1e-9).matrix();
      Eigen::VectorXd move = -damped.ldlt().solve(gradient);
      if (const double longest = move.cwiseAbs().maxCoeff(); longest > kLongest) move *= kLongest / longest;
      const Eigen::VectorXd next = residuals(out.parameters + move);
      const double cost = next.squaredNorm();
      if (!(cost < out.cost)) {
        damping *= 4.0;
        continue;
      }
      gain = out.cost - cost;
      out.parameters += move;
      now = next;
      out.cost = cost;
      damping = std::max(1e-9, damping / 5.0);
    }
    if (gain < kGain) break;
  }
  return out;
}

}  // namespace scree::fractal
