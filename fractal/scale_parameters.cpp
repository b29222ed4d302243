#include "fractal/scale_parameters.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr double kLeastHurst = 0.005, kMostHurst = 0.995;
constexpr double kRoughest = 0.1;

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

}  // namespace

ScaleParameters::ScaleParameters(ScaleLaw law, const LagStatistics& statistics)
    : law_(law),
      statistics_(statistics),
      middle_(std::sqrt(statistics.lags.front().distance * statistics.lags.back().distance)) {}

int ScaleParameters::count() const {
  return law_ == ScaleLaw::power ? 2 : law_ == ScaleLaw::two_scales ? 4 : 3;
}

double ScaleParameters::hurst(double logit) {
  return kLeastHurst + (kMostHurst - kLeastHurst) / (1.0 + std::exp(-logit));
}

double ScaleParameters::logit(double hurst) {
  const double share = (std::clamp(hurst, 0.007, 0.993) - kLeastHurst) / (kMostHurst - kLeastHurst);
  return std::log(share / (1.0 - share));
}

GroundLaw ScaleParameters::ground(const Eigen::VectorXd& parameters) const {
  GroundLaw out;
  out.noise_variance = statistics_.noise_variance;
  out.blur = statistics_.blur;
  // Ground as rough as D > 2.9 that gives way to another is noise: the other law's.
  const double h = std::max(hurst(parameters[kHurst]), law_ == ScaleLaw::two_scales ? kRoughest : 0.0);
  out.first = {std::exp(parameters[0]) * std::pow(middle_, -2.0 * h), h};
  if (law_ == ScaleLaw::power_and_noise) out.noise_variance += 0.5 * std::exp(parameters[2]);
  if (law_ == ScaleLaw::plateau) out.plateau_lag = std::exp(parameters[2]);
  if (law_ == ScaleLaw::two_scales) {
    const double share = 1.0 / (1.0 + std::exp(-parameters[3])), above = h + (kMostHurst - h) * share;
    out.second = {std::exp(parameters[2]) * std::pow(middle_, -2.0 * above), above};
  }
  return out;
}

double ScaleParameters::slope(double from, double to) const {
  const auto& lags = statistics_.lags;
  const auto last = static_cast<double>(lags.size() - 1);
  const Lag &a = lags[static_cast<std::size_t>(from * last)], &b = lags[static_cast<std::size_t>(std::ceil(to * last))];
  return std::clamp(0.5 * (b.log_square - a.log_square) / std::log(b.distance / a.distance), 0.03, 0.97);
}

std::vector<Eigen::VectorXd> ScaleParameters::starts() const {
  const auto& lags = statistics_.lags;
  const auto at = [&](double share) {
    return lags[static_cast<std::size_t>(std::lround(share * static_cast<double>(lags.size() - 1)))];
  };
  const double height = at(0.5).log_square, early = slope(0.0, 0.33), late = slope(0.6, 1.0), all = slope(0.0, 1.0);
  std::vector<Eigen::VectorXd> out;
  switch (law_) {
    case ScaleLaw::power:
      out.push_back(vector_of({height, logit(all)}));
      break;
    case ScaleLaw::power_and_noise:
      for (const double share : {0.1, 0.5, 0.9})
        out.push_back(vector_of({height, logit(late), at(0.0).log_square + std::log(share)}));
      break;
    case ScaleLaw::two_scales:
      for (const double turn : {0.25, 0.5, 0.75}) {
        const double rough = std::min(early, all) - 0.05, smooth = std::max({late, all, 0.3}) + 0.1;
        const double rc = std::log(at(turn).distance / middle_), level = at(turn).log_square - std::log(2.0);
        const double share = (std::min(smooth, 0.97) - hurst(logit(rough))) / (kMostHurst - hurst(logit(rough)));
        out.push_back(vector_of({level - 2.0 * rough * rc, logit(rough), level - 2.0 * smooth * rc,
                                 std::log(std::max(share, 0.02) / (1.0 - std::clamp(share, 0.02, 0.98)))}));
      }
      break;
    case ScaleLaw::plateau:
      for (const double turn : {0.4, 0.7, 1.0}) {
        const double r0 = std::log(at(turn).distance);
        out.push_back(
            vector_of({at(0.2).log_square + 2.0 * early * std::log(middle_ / at(0.2).distance), logit(early), r0}));
      }
      break;
  }
  return out;
}

}  // namespace scree::fractal
