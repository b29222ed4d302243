#include "fractal/vecchia_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fractal/vecchia_neighbours.hpp"

namespace scree::fractal {
namespace {

constexpr double kLeastHurst = 0.01, kMostHurst = 0.995;
constexpr int kMaxPasses = 10;
constexpr std::array<double, 7> kTauGrid = {0.002, 0.01, 0.04, 0.12, 0.35, 1.0, 3.0};
constexpr int kCloseTaus = 5;
constexpr double kCloseStep = 0.25;  // in log τ
// Noise unknown: in the coordinate of FreeTau.
constexpr double kFreeWideStep = 0.75, kFreeCloseStep = 0.3;

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

/// Position of a lane of `lanes` among those of an earlier profile.
double lane_in(const LaneProfile& earlier, const HurstLanes& lanes, std::size_t k) {
  return (lanes.at(static_cast<double>(k)) - earlier.lanes.first) / earlier.lanes.step;
}

enum class Noise { none, known, unknown };

/// Evaluates the likelihood of one survey where it is asked to.
class Likelihood {
 public:
  explicit Likelihood(const VecchiaPoints& survey)
      : survey_(survey),
        predecessors_(nearest_predecessors(survey.points)),
        noise_variance_(survey.noise_variance),
        noise_(survey.noise_unknown          ? Noise::unknown
               : survey.noise_variance > 0.0 ? Noise::known
                                             : Noise::none) {}

  Noise noise() const { return noise_; }
  std::size_t points() const { return survey_.points.size(); }
  /// From now on the noise is known.
  void set_noise(double variance) {
    noise_variance_ = variance;
    noise_ = variance > 0.0 ? Noise::known : Noise::none;
  }

  /// Nothing known of τ.
  LaneProfile wide(const HurstLanes& lanes, std::size_t count) const {
    return noise_ == Noise::none ? clean(lanes, count)
                                 : (noise_ == Noise::known ? known_wide(lanes, count) : free_wide(lanes, count));
  }
  /// τ of each lane close to what an earlier profile found there.
  LaneProfile close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const {
    return noise_ == Noise::none
               ? clean(lanes, count)
               : (noise_ == Noise::known ? known_close(lanes, count, earlier) : free_close(lanes, count, earlier));
  }

 private:
  void add(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, std::span<ErrorSums> sums) const {
    add_errors(std::span(survey_.points).first(count), std::span(predecessors_).first(count), lanes, taus, sums);
  }

  LaneProfile clean(const HurstLanes& lanes, std::size_t count) const {
    const PerLane none{};
    ErrorSums sums;
    add(lanes, count, {&none, 1}, {&sums, 1});
    return clean_profile(lanes, sums, count);
  }

  LaneProfile known(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, bool close) const {
    std::array<ErrorSums, kMaxTaus> sums{};
    const std::span<ErrorSums> used = std::span(sums).first(taus.size());
    add(lanes, count, taus, used);
    return noisy_profile(lanes, taus, used, count, noise_variance_, close);
  }
  /// τ on the wide grid, moved up while the best lane wants more.
  LaneProfile known_wide(const HurstLanes& lanes, std::size_t count) const {
    LaneProfile profile;
    for (double factor = 1.0; factor * kTauGrid.back() < kMostTau; factor *= 243.0) {
      std::array<PerLane, kTauGrid.size()> taus;
      for (std::size_t j = 0; j < taus.size(); ++j) taus[j].fill(factor * kTauGrid[j]);
      profile = known(lanes, count, taus, false);
      if (best_edge(profile) <= 0.0) break;
    }
    return profile;
  }
  LaneProfile known_close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const {
    std::array<PerLane, kCloseTaus> taus;
    for (std::size_t k = 0; k < kHurstLanes; ++k) {
      const double centre = std::min(between_lanes(earlier.log_tau, lane_in(earlier, lanes, k)), std::log(kMostTau));
      for (int j = 0; j < kCloseTaus; ++j)
        taus[static_cast<std::size_t>(j)][k] = std::exp(centre + kCloseStep * (j - kCloseTaus / 2));
    }
    return known(lanes, count, taus, true);
  }

  LaneProfile free(const HurstLanes& lanes, std::size_t count, const PerLane& lowest, double step, bool close) const {
    std::array<PerLane, kMaxTaus> nodes, taus;
    for (std::size_t j = 0; j < kMaxTaus; ++j)
      for (std::size_t k = 0; k < kHurstLanes; ++k) {
        nodes[j][k] = lowest[k] + step * static_cast<double>(j);
        taus[j][k] = FreeTau(lanes.at(static_cast<double>(k))).tau(nodes[j][k]);
      }
    std::array<ErrorSums, kMaxTaus> sums{};
    add(lanes, count, taus, sums);
    return free_noise_profile(lanes, nodes, sums, count, close);
  }
  /// From no noise up, for as long as the best lane wants more.
  LaneProfile free_wide(const HurstLanes& lanes, std::size_t count) const {
    LaneProfile profile;
    const double most = FreeTau(kLeastHurst).coordinate(kMostTau);
    for (double lowest = 0.0; lowest < most; lowest += (kMaxTaus - 2) * kFreeWideStep) {
      PerLane from;
      from.fill(lowest);
      profile = free(lanes, count, from, kFreeWideStep, false);
      if (best_edge(profile) <= 0.0) break;
    }
    return profile;
  }
  LaneProfile free_close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const {
    PerLane lowest;
    for (std::size_t k = 0; k < kHurstLanes; ++k) {
      const double most = FreeTau(lanes.at(static_cast<double>(k))).coordinate(kMostTau);
      const double centre = std::min(between_lanes(earlier.free_tau, lane_in(earlier, lanes, k)), most);
      lowest[k] = std::max(centre - 0.5 * (kMaxTaus - 1) * kFreeCloseStep, 0.0);
    }
    return free(lanes, count, lowest, kFreeCloseStep, true);
  }

  static double best_edge(const LaneProfile& profile) {
    const auto best = std::min_element(profile.minus_two_log.begin(), profile.minus_two_log.end());
    return profile.tau_edge[static_cast<std::size_t>(best - profile.minus_two_log.begin())];
  }

  const VecchiaPoints& survey_;
  std::vector<Predecessors> predecessors_;
  double noise_variance_;
  Noise noise_;
};

double tau_of(const LaneProfile& profile, Noise noise, double lane) {
  if (noise == Noise::none) return 0.0;
  if (noise == Noise::known) return std::exp(between_lanes(profile.log_tau, lane));
  return std::max(FreeTau(profile.lanes.at(lane)).tau(between_lanes(profile.free_tau, lane)), 0.0);
}

/// A lane that may matter has its best τ at the end of those tried.
bool tau_wants_more(const LaneProfile& profile, Noise noise) {
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
LaneProfile look(const Likelihood& likelihood, std::size_t count) {
  const HurstLanes all;
  const LaneProfile profile = likelihood.wide(all, count);
  return likelihood.noise() == Noise::none || count == likelihood.points() ? profile
                                                                           : likelihood.close(all, count, profile);
}

/// From a first look to all points around what it found, until the lanes are dense and wide enough and τ lies within
/// its nodes.
void refine(const Likelihood& likelihood, VecchiaOutcome& now) {
  HurstLanes lanes = lanes_around(now.fit.hurst, now.fit.sigma);
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    now.profile = likelihood.close(lanes, likelihood.points(), now.profile);
    now.fit = fit_hurst(now.profile);
    if (lanes_want_more(now.profile, now.fit)) {
      lanes = lanes_around(now.fit.hurst, std::max(now.fit.sigma, lanes.step * kHurstLanes / 6.0));
    } else if (likelihood.noise() == Noise::none || !tau_wants_more(now.profile, likelihood.noise())) {
      break;
    }
  }
}

}  // namespace

VecchiaOutcome search_likelihood(const VecchiaPoints& survey) {
  Likelihood likelihood(survey);
  const std::size_t points = survey.points.size(), part = first_look(points);
  const Noise noise = likelihood.noise();
  const std::size_t count = noise == Noise::unknown ? first_look_for_noise(points) : part;
  VecchiaOutcome now;
  now.profile = look(likelihood, count);
  now.coarse_points = part;
  now.fit = now.coarse = fit_hurst(now.profile);
  const bool dense = now.fit.sigma > 0.5 * now.profile.lanes.step;
  if (count < points || !dense || noise != Noise::none) refine(likelihood, now);
  now.tau = tau_of(now.profile, noise, now.fit.lane);
  if (noise == Noise::unknown && part < points) {  // with the noise that all points together say
    likelihood.set_noise(now.tau * std::exp(between_lanes(now.profile.log_c, now.fit.lane)));
    now.coarse = fit_hurst(look(likelihood, part));
  }
  return now;
}

}  // namespace scree::fractal
