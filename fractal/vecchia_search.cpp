#include "fractal/vecchia_search.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/vecchia_likelihood.hpp"

namespace scree::fractal {
namespace {

constexpr int kMaxPasses = 10;

/// Points of the first look: their order is random, so they are a fair sample, of twice the spacing or more.
std::size_t first_look(std::size_t points) {
  constexpr std::size_t kFew = 1200, kLeast = 300, kMost = 1024;
  return points < kFew ? points : std::clamp(points / 4, kLeast, kMost);
}

/// Where the noise is to be found as well, fewer than a thousand points say nothing.
std::size_t first_look_for_noise(std::size_t points) {
  constexpr std::size_t kFew = 2000, kPart = 1024;
  return points < kFew ? points : kPart;
}

/// Lanes over H ± 4σ; never closer than rounding allows.
HurstLanes lanes_around(double hurst, double sigma) {
  const double reach = std::max(4.0 * sigma, 1e-4);
  const double low = std::clamp(hurst - reach, kLeastHurst, kMostHurst - 2e-4);
  const double high = std::clamp(hurst + reach, low + 1e-4, kMostHurst);
  return {low, (high - low) / (kHurstLanes - 1)};
}

/// A lane that may matter has its best τ at the end of those tried.
bool tau_wants_more(const LaneProfile& profile, VecchiaNoise noise) {
  constexpr double kMatters = 10.0;
  const double least = *std::min_element(profile.minus_two_log.begin(), profile.minus_two_log.end());
  for (std::size_t k = 0; k < kHurstLanes; ++k)
    if (profile.tau_edge[k] != 0.0 && profile.minus_two_log[k] < least + kMatters &&
        tau_of(profile, noise, static_cast<double>(k)) < kMostTau)
      return true;
  return false;
}

/// The lanes end before the likelihood has fallen, and H could go on.
bool lanes_want_more(const LaneProfile& profile, const HurstFit& fit) {
  const double first = profile.lanes.first, last = profile.lanes.at(kHurstLanes - 1);
  return (fit.low_open && first > kLeastHurst + 0.011) || (fit.high_open && last < kMostHurst - 0.011);
}

/// A look at all H on a part of the points.
LaneProfile look(const VecchiaLikelihood& likelihood, std::size_t count) {
  const HurstLanes all;
  const LaneProfile profile = likelihood.wide(all, count);
  return likelihood.noise() == VecchiaNoise::none || count == likelihood.points()
             ? profile
             : likelihood.close(all, count, profile);
}

/// From a first look to all points around what it found, until the lanes are dense and wide enough and τ lies within
/// its nodes.
void refine(const VecchiaLikelihood& likelihood, VecchiaOutcome& now) {
  HurstLanes lanes = lanes_around(now.fit.hurst, now.fit.sigma);
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    now.profile = likelihood.close(lanes, likelihood.points(), now.profile);
    now.fit = fit_hurst(now.profile);
    if (lanes_want_more(now.profile, now.fit)) {
      lanes = lanes_around(now.fit.hurst, std::max(now.fit.sigma, lanes.step * kHurstLanes / 6.0));
    } else if (likelihood.noise() == VecchiaNoise::none || !tau_wants_more(now.profile, likelihood.noise())) {
      break;
    }
  }
}

}  // namespace

VecchiaOutcome search_likelihood(const VecchiaPoints& survey) {
  VecchiaLikelihood likelihood(survey);
  const std::size_t points = survey.points.size(), part = first_look(points);
  const VecchiaNoise noise = likelihood.noise();
  const std::size_t count = noise == VecchiaNoise::unknown ? first_look_for_noise(points) : part;
  VecchiaOutcome now;
  now.profile = look(likelihood, count);
  now.coarse_points = part;
  now.fit = now.coarse = fit_hurst(now.profile);
  const bool dense = now.fit.sigma > 0.5 * now.profile.lanes.step;
  if (count < points || !dense || noise != VecchiaNoise::none) refine(likelihood, now);
  now.tau = tau_of(now.profile, noise, now.fit.lane);
  now.minus_two_log = between_lanes(now.profile.minus_two_log, now.fit.lane);
  // With a known noise the quadratic form over C is part of the value; without, it is the number of contrasts.
  if (noise == VecchiaNoise::known) now.minus_two_log -= contrast_count(points);
  if (noise == VecchiaNoise::unknown && part < points) {  // with the noise that all points together say
    likelihood.set_noise(now.tau * std::exp(between_lanes(now.profile.log_c, now.fit.lane)));
    now.coarse = fit_hurst(look(likelihood, part));
  }
  return now;
}

}  // namespace scree::fractal
