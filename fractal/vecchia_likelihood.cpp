#include "fractal/vecchia_likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr std::array<double, 7> kTauGrid = {0.002, 0.01, 0.04, 0.12, 0.35, 1.0, 3.0};
constexpr int kCloseTaus = 5;
constexpr double kCloseStep = 0.25;  // in log τ
// Noise unknown: in the coordinate of FreeTau.
constexpr double kFreeWideStep = 0.75, kFreeCloseStep = 0.3;

/// Position of a lane of `lanes` among those of an earlier profile.
double lane_in(const LaneProfile& earlier, const HurstLanes& lanes, std::size_t k) {
  return (lanes.at(static_cast<double>(k)) - earlier.lanes.first) / earlier.lanes.step;
}

/// Of the best lane.
double best_edge(const LaneProfile& profile) {
  const auto best = std::min_element(profile.minus_two_log.begin(), profile.minus_two_log.end());
  return profile.tau_edge[static_cast<std::size_t>(best - profile.minus_two_log.begin())];
}

VecchiaNoise noise_of(const VecchiaPoints& survey) {
  if (survey.noise_unknown) return VecchiaNoise::unknown;
  return survey.noise_variance > 0.0 ? VecchiaNoise::known : VecchiaNoise::none;
}

}  // namespace

VecchiaLikelihood::VecchiaLikelihood(const VecchiaPoints& survey)
    : survey_(survey),
      predecessors_(nearest_predecessors(survey.points)),
      noise_variance_(survey.noise_variance),
      noise_(noise_of(survey)) {}

void VecchiaLikelihood::set_noise(double variance) {
  noise_variance_ = variance;
  noise_ = variance > 0.0 ? VecchiaNoise::known : VecchiaNoise::none;
}

LaneProfile VecchiaLikelihood::wide(const HurstLanes& lanes, std::size_t count) const {
  return noise_ == VecchiaNoise::none
             ? clean(lanes, count)
             : (noise_ == VecchiaNoise::known ? known_wide(lanes, count) : free_wide(lanes, count));
}

LaneProfile VecchiaLikelihood::close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const {
  return noise_ == VecchiaNoise::none
             ? clean(lanes, count)
             : (noise_ == VecchiaNoise::known ? known_close(lanes, count, earlier) : free_close(lanes, count, earlier));
}

void VecchiaLikelihood::add(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus,
                            std::span<ErrorSums> sums) const {
  add_errors(std::span(survey_.points).first(count), std::span(predecessors_).first(count), lanes, taus, sums);
}

LaneProfile VecchiaLikelihood::clean(const HurstLanes& lanes, std::size_t count) const {
  const PerLane none{};
  ErrorSums sums;
  add(lanes, count, {&none, 1}, {&sums, 1});
  return clean_profile(lanes, sums, count);
}

LaneProfile VecchiaLikelihood::known(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus,
                                     bool close) const {
  std::array<ErrorSums, kMaxTaus> sums{};
  const std::span<ErrorSums> used = std::span(sums).first(taus.size());
  add(lanes, count, taus, used);
  return noisy_profile(lanes, taus, used, count, noise_variance_, close);
}

/// τ on the wide grid, moved up while the best lane wants more.
LaneProfile VecchiaLikelihood::known_wide(const HurstLanes& lanes, std::size_t count) const {
  LaneProfile profile;
  for (double factor = 1.0; factor * kTauGrid.back() < kMostTau; factor *= 243.0) {
    std::array<PerLane, kTauGrid.size()> taus;
    for (std::size_t j = 0; j < taus.size(); ++j) taus[j].fill(factor * kTauGrid[j]);
    profile = known(lanes, count, taus, false);
    if (best_edge(profile) <= 0.0) break;
  }
  return profile;
}

LaneProfile VecchiaLikelihood::known_close(const HurstLanes& lanes, std::size_t count,
                                           const LaneProfile& earlier) const {
  std::array<PerLane, kCloseTaus> taus;
  for (std::size_t k = 0; k < kHurstLanes; ++k) {
    const double centre = std::min(between_lanes(earlier.log_tau, lane_in(earlier, lanes, k)), std::log(kMostTau));
    for (int j = 0; j < kCloseTaus; ++j)
      taus[static_cast<std::size_t>(j)][k] = std::exp(centre + kCloseStep * (j - kCloseTaus / 2));
  }
  return known(lanes, count, taus, true);
}

LaneProfile VecchiaLikelihood::free(const HurstLanes& lanes, std::size_t count, const PerLane& lowest, double step,
                                    bool close) const {
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
LaneProfile VecchiaLikelihood::free_wide(const HurstLanes& lanes, std::size_t count) const {
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

LaneProfile VecchiaLikelihood::free_close(const HurstLanes& lanes, std::size_t count,
                                          const LaneProfile& earlier) const {
  PerLane lowest;
  for (std::size_t k = 0; k < kHurstLanes; ++k) {
    const double most = FreeTau(lanes.at(static_cast<double>(k))).coordinate(kMostTau);
    const double centre = std::min(between_lanes(earlier.free_tau, lane_in(earlier, lanes, k)), most);
    lowest[k] = std::max(centre - 0.5 * (kMaxTaus - 1) * kFreeCloseStep, 0.0);
  }
  return free(lanes, count, lowest, kFreeCloseStep, true);
}

double tau_of(const LaneProfile& profile, VecchiaNoise noise, double lane) {
  if (noise == VecchiaNoise::none) return 0.0;
  if (noise == VecchiaNoise::known) return std::exp(between_lanes(profile.log_tau, lane));
  return std::max(FreeTau(profile.lanes.at(lane)).tau(between_lanes(profile.free_tau, lane)), 0.0);
}

}  // namespace scree::fractal
