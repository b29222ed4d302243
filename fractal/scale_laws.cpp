#include "fractal/scale_laws.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "fractal/lag_fit.hpp"
#include "fractal/least_squares.hpp"
#include "fractal/scale_parameters.hpp"

namespace scree::fractal {
namespace {

constexpr std::array<ScaleLaw, 4> kLaws{ScaleLaw::power, ScaleLaw::power_and_noise, ScaleLaw::two_scales,
                                        ScaleLaw::plateau};
constexpr int kRounds = 3;

/// A law at its best under the weights of the moment.
struct Fitted {
  LeastSquares at;
  GroundLaw ground;
  Interval interval95;
};

/// H ends a little within 0 and 1: an interval that gets there has no end.
Interval opened(Interval interval) {
  constexpr double kEnd = 0.006;
  if (interval.low < 2.0 + kEnd) interval.low = 2.0;
  if (interval.high > 3.0 - kEnd) interval.high = 3.0;
  return interval;
}

/// 1.96 standard deviations either side of D. Of the logit of H, but where H is at its bound and the logit runs away:
/// there of H itself, by what the fit loses a hundredth inside.
template <class Residuals>
Interval interval_of(const LeastSquares& at, const Residuals& residuals) {
  constexpr double kReach = 1.959964, kRunsAway = 5.0, kInside = 0.01;
  constexpr Eigen::Index kHurst = ScaleParameters::kHurst;
  const double logit = at.parameters[kHurst], hurst = ScaleParameters::hurst(logit);
  const auto deviation = [](const Eigen::MatrixXd& jacobian) {
    const double variance = (jacobian.transpose() * jacobian).inverse()(kHurst, kHurst);
    return variance > 0.0 ? std::sqrt(variance) : 50.0;
  };
  if (std::abs(logit) < kRunsAway) {
    const double reach = kReach * deviation(at.jacobian);
    return opened({3.0 - ScaleParameters::hurst(logit + reach), 3.0 - ScaleParameters::hurst(logit - reach)});
  }
  Eigen::VectorXd inside = at.parameters;
  inside[kHurst] = ScaleParameters::logit(hurst - std::copysign(kInside, logit));
  Eigen::MatrixXd jacobian = at.jacobian;
  jacobian.col(kHurst) = (residuals(inside) - residuals(at.parameters)) / kInside;
  const double reach = kReach * deviation(jacobian);
  return {std::max(2.0, 3.0 - hurst - reach), std::min(3.0, 3.0 - hurst + reach)};
}

/// One survey's lags and the weights that all laws share.
class Analysis {
 public:
  explicit Analysis(const LagStatistics& statistics) : statistics_(statistics), model_(statistics), fit_(statistics) {}

  void weigh(const GroundLaw& ground) { fit_.weigh(model_, tempered(ground)); }

  Fitted fit(ScaleLaw law) const {
    const ScaleParameters parameters(law, statistics_);
    const auto residuals = [&](const Eigen::VectorXd& p) {
      return fit_.residual(model_.expected(parameters.ground(p)).array().log());
    };
    LeastSquares best;
    for (const auto& start : parameters.starts())
      if (LeastSquares found = minimise(residuals, start); best.parameters.size() == 0 || found.cost < best.cost)
        best = std::move(found);
    const GroundLaw ground = parameters.ground(best.parameters);
    const Interval interval = interval_of(best, residuals);
    return {std::move(best), ground, interval};
  }

  double criterion(const Fitted& fitted) const {
    const auto parameters = static_cast<std::size_t>(fitted.at.parameters.size());
    return fitted.at.cost + kCharge[parameters - 2] * std::log(static_cast<double>(statistics_.lags.size()));
  }
  const LagModel& model() const { return model_; }

 private:
  /// Smoother than H = .93 a plane is nearly all there is, and the waves that are left have no Gaussian errors: weights
  /// are those of rougher ground with the same change over distances in the middle.
  GroundLaw tempered(GroundLaw ground) const {
    const double middle = std::sqrt(statistics_.lags.front().distance * statistics_.lags.back().distance);
    for (GroundLaw::Power* power : {&ground.first, &ground.second}) {
      const double hurst = std::min(power->hurst, 0.93);
      power->square *= std::pow(middle, 2.0 * (power->hurst - hurst));
      power->hurst = hurst;
    }
    return ground;
  }

  /// For two, three and four parameters. A parameter counts ln n, leaving the plain power law as much again; the fourth
  /// half as much, for two scales do not contain power and noise (their H is at least .1). Measured: docs/fractal.md.
  static constexpr std::array<double, 3> kCharge{2.0, 4.0, 4.5};
  const LagStatistics& statistics_;
  LagModel model_;
  LagFit fit_;
};

std::size_t cheapest(const Analysis& analysis, const std::array<Fitted, 4>& fits, std::size_t first) {
  std::size_t best = first;
  for (std::size_t i = first + 1; i < fits.size(); ++i)
    if (analysis.criterion(fits[i]) < analysis.criterion(fits[best])) best = i;
  return best;
}

std::array<Fitted, 4> fit_all(const Analysis& analysis) {
  std::array<Fitted, 4> fits;
  for (std::size_t i = 0; i < fits.size(); ++i) fits[i] = analysis.fit(kLaws[i]);
  return fits;
}

/// Distance at which the slope of a growing law is half-way between H and that of the other term.
void mark_range(const GroundLaw& ground, const LagStatistics& statistics, ScaleLawFit& out) {
  const double h2 = 2.0 * ground.first.hurst;
  const double shortest = statistics.lags.front().distance, longest = statistics.lags.back().distance;
  const auto looked_at = [&](double lag) { return lag >= shortest && lag <= longest; };
  double low = shortest, high = longest;
  // C·d^(2H) = noise: the slope there is H/2. Blurred places look like noise as well.
  const double white = 2.0 * ground.white_variance();
  if (white > 0.0) low = std::max(low, std::pow(white / ground.first.square, 1.0 / h2));
  if (ground.second.square > 0.0) {
    const double crossover =
        std::pow(ground.first.square / ground.second.square, 1.0 / (2.0 * ground.second.hurst - h2));
    if (looked_at(crossover)) out.crossover_m = crossover * statistics.spacing_m;
    high = std::min(high, crossover);
  }
  if (ground.plateau_lag > 0.0) {
    constexpr double kHalfSlope = 1.2564312;  // x/(e^x − 1) = 1/2
    if (looked_at(ground.plateau_lag)) out.crossover_m = ground.plateau_lag * statistics.spacing_m;
    high = std::min(high, ground.plateau_lag * std::pow(kHalfSlope, 1.0 / h2));
  }
  out.lag_min_m = std::clamp(std::min(low, high), shortest, longest) * statistics.spacing_m;
  out.lag_max_m = std::clamp(std::max(low, high), shortest, longest) * statistics.spacing_m;
}

ScaleLawFit describe(const Fitted& fitted, ScaleLaw law, const LagStatistics& statistics) {
  ScaleLawFit out;
  out.law = law;
  out.parameters = static_cast<int>(fitted.at.parameters.size());
  out.chi_square = fitted.at.cost;
  out.degrees_of_freedom = static_cast<int>(statistics.lags.size()) - out.parameters;
  const GroundLaw& ground = fitted.ground;
  out.dimension = 3.0 - ground.first.hurst;
  out.amplitude_m =
      std::sqrt(ground.first.square) * statistics.height_m * std::pow(statistics.spacing_m, -ground.first.hurst);
  out.interval95 = fitted.interval95;
  if (law == ScaleLaw::power_and_noise)
    out.noise_sigma_m = std::sqrt(ground.noise_variance - statistics.noise_variance) * statistics.height_m;
  if (law == ScaleLaw::two_scales) out.coarse_dimension = 3.0 - ground.second.hurst;
  if (law == ScaleLaw::plateau)
    out.plateau_m =
        std::sqrt(ground.first.square) * std::pow(ground.plateau_lag, ground.first.hurst) * statistics.height_m;
  mark_range(ground, statistics, out);
  return out;
}

/// Points and model in metres, as the plot shows them.
void draw(const LagModel& model, const GroundLaw& ground, const LagStatistics& statistics, ScaleAnalysis& out) {
  const Eigen::VectorXd expected = model.expected(ground);
  for (Eigen::Index l = 0; l < expected.size(); ++l) {
    const Lag& lag = statistics.lags[static_cast<std::size_t>(l)];
    const double total = ground.variogram(lag.distance) + 2.0 * (ground.noise_variance + statistics.slope_noise);
    const double corrected = lag.log_square + std::log(total / expected[l]);
    out.points.push_back(
        {std::log(lag.distance * statistics.spacing_m), 0.5 * corrected + std::log(statistics.height_m), lag.pairs});
    out.log_model.push_back(0.5 * std::log(total) + std::log(statistics.height_m));
  }
}

}  // namespace

Result<ScaleAnalysis> analyse_scales(const SurveyPoints& survey, const StructureDimensionOptions& options,
                                     Executor& executor) {
  const auto statistics = lag_statistics(survey, {options.max_lag_m, options.seed}, executor);
  if (!statistics) return statistics.error();
  Analysis analysis(*statistics);
  const ScaleParameters power(ScaleLaw::power, *statistics);
  GroundLaw weights = power.ground(power.starts().front());
  for (int round = 0; round < kRounds; ++round) {
    analysis.weigh(weights);
    weights = analysis.fit(ScaleLaw::power).ground;
  }
  analysis.weigh(weights);
  std::array<Fitted, 4> fits = fit_all(analysis);
  std::size_t chosen = cheapest(analysis, fits, 0);
  // A law that replaces the power law is judged among the others by its own weights.
  for (int round = 0; chosen != 0 && round < kRounds; ++round) {
    analysis.weigh(fits[chosen].ground);
    fits = fit_all(analysis);
    const std::size_t before = chosen;
    chosen = cheapest(analysis, fits, 1);
    if (chosen == before && round > 0) break;
  }
  ScaleAnalysis out;
  out.chosen = chosen;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    out.fits.push_back(describe(fits[i], kLaws[i], *statistics));
    out.fits.back().criterion = analysis.criterion(fits[i]);
  }
  draw(analysis.model(), fits[chosen].ground, *statistics, out);
  return out;
}

}  // namespace scree::fractal
