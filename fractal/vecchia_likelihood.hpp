#pragma once
// The likelihood of one survey, evaluated where it is asked to.

#include <span>
#include <vector>

#include "fractal/vecchia_neighbours.hpp"
#include "fractal/vecchia_points.hpp"
#include "fractal/vecchia_profile.hpp"

namespace scree::fractal {

inline constexpr double kLeastHurst = 0.01, kMostHurst = 0.995;
inline constexpr double kMostTau = 3.0e4;  ///< beyond it the ground is invisible

enum class VecchiaNoise { none, known, unknown };

/// Profiles over the lanes of H with plane, amplitude and, where there is noise, τ at their best. Refers to the survey.
class VecchiaLikelihood {
 public:
  explicit VecchiaLikelihood(const VecchiaPoints& survey);

  VecchiaNoise noise() const { return noise_; }
  std::size_t points() const { return survey_.points.size(); }
  /// From now on the noise is known: its variance in units of height_m².
  void set_noise(double variance);

  /// From the first `count` points; nothing known of τ.
  LaneProfile wide(const HurstLanes& lanes, std::size_t count) const;
  /// τ of each lane close to what an earlier profile found there.
  LaneProfile close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const;

 private:
  void add(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, std::span<ErrorSums> sums) const;
  LaneProfile clean(const HurstLanes& lanes, std::size_t count) const;
  LaneProfile known(const HurstLanes& lanes, std::size_t count, std::span<const PerLane> taus, bool close) const;
  LaneProfile known_wide(const HurstLanes& lanes, std::size_t count) const;
  LaneProfile known_close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const;
  LaneProfile free(const HurstLanes& lanes, std::size_t count, const PerLane& lowest, double step, bool close) const;
  LaneProfile free_wide(const HurstLanes& lanes, std::size_t count) const;
  LaneProfile free_close(const HurstLanes& lanes, std::size_t count, const LaneProfile& earlier) const;

  const VecchiaPoints& survey_;
  std::vector<Predecessors> predecessors_;
  double noise_variance_;
  VecchiaNoise noise_;
};

/// The best τ of a profile at a lane, fractional.
double tau_of(const LaneProfile& profile, VecchiaNoise noise, double lane);

}  // namespace scree::fractal
