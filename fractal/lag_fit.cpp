#include "fractal/lag_fit.hpp"

#include <algorithm>

namespace scree::fractal {
namespace {

constexpr double kRidge = 2e-4;
// Displaced places turn the slopes of the ground at hand into noise that is not the same everywhere.
constexpr double kBlurRidge = 0.01;

}  // namespace

LagFit::LagFit(const LagStatistics& statistics) : blur_(statistics.blur) {
  log_square_.resize(static_cast<Eigen::Index>(statistics.lags.size()));
  for (Eigen::Index l = 0; l < log_square_.size(); ++l)
    log_square_[l] = statistics.lags[static_cast<std::size_t>(l)].log_square;
  observed_ = log_square_;
}

void LagFit::weigh(const LagModel& model, const GroundLaw& law) {
  Eigen::MatrixXd covariance = model.covariance(law);
  observed_ = log_square_ + 0.5 * covariance.diagonal();
  covariance.diagonal() *= 1.0 + kRidge + kBlurRidge * std::min(1.0, blur_ * blur_);
  root_.compute(covariance);
  // Ground that is all but a plane: nearly nothing is left of it, and its errors are all alike.
  for (double ridge = 1e-3; root_.info() != Eigen::Success && ridge < 10.0; ridge *= 10.0) {
    covariance.diagonal() *= 1.0 + ridge;
    root_.compute(covariance);
  }
}

}  // namespace scree::fractal
