#include "fractal/vecchia.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fractal/vecchia_lanes.hpp"
#include "fractal/vecchia_neighbours.hpp"
#include "fractal/vecchia_points.hpp"
#include "fractal/vecchia_profile.hpp"

namespace scree::fractal {
namespace {

constexpr double kLeastHurst = 0.01, kMostHurst = 0.995;
constexpr int kMaxPasses = 10;
constexpr std::array<double, 7> kTauGrid = {0.002, 0.01, 0.04, 0.12, 0.35, 1.0, 3.0};
constexpr double kMostTau = 3.0e4;  // beyond it the ground is invisible
constexpr int kCloseTaus = 5;
constexpr double kCloseStep = 0.25;  // in log τ

/// Points of the first look: their order is random, so they are a fair sample, of twice the spacing or more.
std::size_t first_look(std::size_t points) {
  constexpr std::size_t kFew = 1200, kLeast = 300, kMost = 1024;
  return points < kFew ? points : std::clamp(points / 4, kLeast, kMost);
}

/// Lanes over H ± 4σ; never closer than rounding allows.
HurstLanes lanes_around(double hurst, double sigma) {
  const double reach = std::max(4.0 * sigma, 1e-4);
  const double low = std::clamp(hurst - reach, kLeastHurst, kMostHurst - 2e-4);
  const double high = std::clamp(hurst + reach, low + 1e-4, kMostHurst);
  return {low, (high - low) / (kHurstLanes - 1)};
}

/// Evaluates the likelihood of one survey where it is asked to.
class Likelihood {
 public:
  explicit Likelihood(const VecchiaPoints& survey)
      : survey_(survey), predecessors_(nearest_predecessors(survey.points)) {}

  bool noisy() const { return survey_.noise_variance > 0.0; }

  LaneProfile clean(const HurstLanes& lanes, std::size_t count) const {
    const PerLane none{};
    ErrorSums sums;
    add(lanes, count, {&none, 1}, {&sums, 1});
    return clean_profile(lanes, sums, count);
  }

  /// τ on the wide grid, moved up while the best lane wants more.
  LaneProfile noisy_wide(const HurstLanes& lanes, std::size_t count) const {
    LaneProfile profile;
    for (double factor = 1.0; factor * kTauGrid.back() < kMostTau; factor *= 243.0) {
      std::array<PerLane, kTauGrid.size()> taus;
      for (std::size_t j = 0; j < taus.size(); ++j) taus[j].fill(factor * kTauGrid[j]);
      profile = noisy(lanes, count, taus, false);
      const auto best = std::min_element(profile.minus_two_log.begin(), profile.minus_two_log.end());
      if (profile.tau_edge[static_cast<std::size_t>(best - profile.minus_two_log.begin())] <= 0.0) break;
    }
    return profile;
  }

  /// τ of each lane close to what an earlier profile found there.
  LaneProfile noisy_close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const {
    std::array<PerLane, kCloseTaus> taus;
    for (std::size_t k = 0; k < kHurstLanes; ++k) {
      const double lane = (lanes.at(static_cast<double>(k)) - earlier.lanes.first) / earlier.lanes.step;
      const double centre = std::min(between_lanes(earlier.log_tau, lane), std::log(kMostTau));
      for (int j = 0; j < kCloseTaus; ++j)
        taus[static_cast<std::size_t>(j)][k] = std::exp(centre + kCloseStep * (j - kCloseTaus / 2));
    }
    return noisy(lanes, count, taus, true);
  }

 private:
  void add(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, std::span<ErrorSums> sums) const {
    add_errors(std::span(survey_.points).first(count), std::span(predecessors_).first(count), lanes, taus, sums);
  }
  LaneProfile noisy(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, bool close) const {
    std::array<ErrorSums, kMaxTaus> sums{};
    const std::span<ErrorSums> used = std::span(sums).first(taus.size());
    add(lanes, count, taus, used);
    return noisy_profile(lanes, taus, used, count, survey_.noise_variance, close);
  }

  const VecchiaPoints& survey_;
  std::vector<Predecessors> predecessors_;
};

/// A lane that may matter has its best τ at the end of those tried.
bool tau_wants_more(const LaneProfile& profile) {
  constexpr double kMatters = 10.0;
  const double least = *std::min_element(profile.minus_two_log.begin(), profile.minus_two_log.end());
  for (std::size_t k = 0; k < kHurstLanes; ++k)
    if (profile.tau_edge[k] != 0.0 && profile.minus_two_log[k] < least + kMatters &&
        profile.log_tau[k] < std::log(kMostTau))
      return true;
  return false;
}

/// The lanes end before the likelihood has fallen, and H could go on.
bool lanes_want_more(const LaneProfile& profile, const HurstFit& fit) {
  const double first = profile.lanes.first, last = profile.lanes.at(kHurstLanes - 1);
  return (fit.low_open && first > kLeastHurst + 0.011) || (fit.high_open && last < kMostHurst - 0.011);
}

struct Outcome {
  LaneProfile profile;
  HurstFit fit;
  HurstFit coarse;            ///< of the first look
  std::size_t coarse_points;  ///< behind it
};

/// A first look at all H on a part of the points, then all points around what it found, until the lanes are dense and
/// wide enough and τ lies within its nodes.
Outcome search(const Likelihood& likelihood, std::size_t points) {
  std::size_t count = first_look(points);
  const HurstLanes wide;
  Outcome now{likelihood.noisy() ? likelihood.noisy_wide(wide, count) : likelihood.clean(wide, count), {}, {}, count};
  if (likelihood.noisy() && count < points) now.profile = likelihood.noisy_close(wide, count, now.profile);
  now.fit = now.coarse = fit_hurst(now.profile);
  const bool dense = now.fit.sigma > 0.5 * wide.step;
  if (count == points && dense && !likelihood.noisy()) return now;
  HurstLanes lanes = lanes_around(now.fit.hurst, now.fit.sigma);
  count = points;
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    now.profile =
        likelihood.noisy() ? likelihood.noisy_close(lanes, count, now.profile) : likelihood.clean(lanes, count);
    now.fit = fit_hurst(now.profile);
    if (lanes_want_more(now.profile, now.fit)) {
      lanes = lanes_around(now.fit.hurst, std::max(now.fit.sigma, lanes.step * kHurstLanes / 6.0));
    } else if (!likelihood.noisy() || !tau_wants_more(now.profile)) {
      break;
    }
  }
  return now;
}

DimensionEstimate describe(const Outcome& outcome, const VecchiaPoints& survey) {
  const HurstFit& fit = outcome.fit;
  DimensionEstimate out;
  out.dimension = 3.0 - fit.hurst;
  out.sigma = fit.sigma;
  out.interval95 = {fit.high_open ? 2.0 : 3.0 - fit.high, fit.low_open ? 3.0 : 3.0 - fit.low};
  if (fit.high_open) out.flags |= kOpenBelow;
  if (fit.low_open) out.flags |= kOpenAbove;
  const double c = std::exp(between_lanes(outcome.profile.log_c, fit.lane));
  out.amplitude_m = std::sqrt(c) * survey.height_m * std::pow(survey.spacing_m, -fit.hurst);
  out.relative_noise = survey.noise_variance / c;
  if (out.relative_noise > 1.0) out.flags |= kNoiseHides;
  const std::size_t points = survey.points.size();
  if (outcome.coarse_points == points) return out;
  out.coarse_dimension = 3.0 - outcome.coarse.hurst;
  out.coarse_spacing_m =
      survey.spacing_m * std::sqrt(static_cast<double>(points) / static_cast<double>(outcome.coarse_points));
  constexpr double kDeviations = 3.3;
  if (std::abs(out.dimension - out.coarse_dimension) > kDeviations * std::hypot(outcome.coarse.sigma, fit.sigma))
    out.flags |= kScaleDependent;
  return out;
}

}  // namespace

Result<DimensionEstimate> estimate_dimension_vecchia(const SurveyPoints& survey) {
  const auto prepared = prepare_points(survey);
  if (!prepared) return prepared.error();
  const Likelihood likelihood(*prepared);
  const Outcome outcome = search(likelihood, prepared->points.size());
  DimensionEstimate out = describe(outcome, *prepared);
  if (out.relative_noise > 0.5 * kMostTau) {  // amplitude 0 is as likely as any
    out.dimension = out.sigma = out.amplitude_m = std::numeric_limits<double>::quiet_NaN();
    out.interval95 = {};
    out.flags |= kOpenBelow | kOpenAbove;
  }
  out.method = "vecchia";
  out.points = prepared->points.size();
  out.duplicates = prepared->duplicates;
  if (out.duplicates > 0) out.flags |= kDuplicatesMerged;
  out.spacing_m = prepared->spacing_m;
  out.noise_sigma_m = std::sqrt(prepared->noise_variance) * prepared->height_m;
  constexpr double kWideNoise = 0.3;
  if (survey.noise_xy_sigma_m >= kWideNoise * out.spacing_m) out.flags |= kHorizontalNoise;
  return out;
}

}  // namespace scree::fractal
