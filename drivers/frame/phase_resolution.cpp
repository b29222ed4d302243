#include "drivers/frame/phase_resolution.hpp"

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

constexpr int kMajority = 10;               // the winner's votes are at least this many times the runner-up's
constexpr double kGroundShare = 2.0 / 3.0;  // of the pixels asked for ground near the robot, those that must read it
constexpr double kMapShare = 0.3;           // of the candidates over mapped ground, those that must lie on it
constexpr double kFirstIntervalShare = 0.05;

}  // namespace

bool PhaseResolver::resolve(const Scene& scene, Surfaces& surfaces, Grid<PixelState>& state, Grid<float>& range_m,
                            Grid<std::int8_t>& wraps) {
  const FilterConfig& filter = scene.tables.sensor->filter;
  wraps.assign(state.rows(), state.columns(), 0);
  labelled_ = state;
  evidence_.collect(scene.tables, scene.poses, scene.ground, surfaces, state, range_m);
  decisions_.clear();
  for (const SurfaceEvidence& surface : evidence_.surfaces()) decisions_.push_back(decide(surface, filter));

  const bool assumed = filter.phase == PhasePolicy::first_interval && !decisions_.empty() && !any(Verdict::anchored) &&
                       !any(Verdict::contradiction);
  if (assumed) assume_first_interval(surfaces, state);
  apply(scene.tables, surfaces, labelled_, state, range_m, wraps);
  if (any(Verdict::contradiction)) split_contradictions(scene, surfaces, state, range_m, wraps);
  return assumed;
}

/// Votes of the ground near the robot and of the map add up. The map alone must also agree with a fair share of what
/// it covers: a wall that crosses the mapped ground along a line touches it with few of its pixels.
PhaseResolver::Decision PhaseResolver::decide(const SurfaceEvidence& evidence, const FilterConfig& filter) {
  std::int32_t best = 0;
  std::int32_t second = 0;
  std::size_t best_bin = 0;
  for (std::size_t bin = 0; bin < evidence.ground.size(); ++bin) {
    const std::int32_t votes = evidence.ground[bin] + evidence.mapped[bin];
    if (votes > best) {
      second = best;
      best = votes;
      best_bin = bin;
    } else {
      second = std::max(second, votes);
    }
  }
  if (best < filter.anchor_min_pixels) return {};
  const int interval = static_cast<int>(best_bin) - SurfaceEvidence::kBins / 2;
  if (second * kMajority > best || evidence.twisted) return {Verdict::contradiction, interval};
  if (evidence.asked >= filter.anchor_min_pixels && evidence.anchor[best_bin] < kGroundShare * evidence.asked)
    return {Verdict::contradiction, interval};
  const bool on_ground = evidence.anchor[best_bin] >= filter.anchor_min_pixels &&
                         evidence.anchor_plane.slope() <= std::tan(filter.anchor_slope_rad);
  const bool on_map = evidence.mapped[best_bin] >= filter.anchor_min_pixels &&
                      evidence.mapped[best_bin] >= kMapShare * evidence.covered[best_bin];
  if (!on_ground && !on_map) return {};
  return {Verdict::anchored, interval};
}

bool PhaseResolver::any(Verdict verdict) const {
  return std::any_of(decisions_.begin(), decisions_.end(),
                     [verdict](const Decision& decision) { return decision.verdict == verdict; });
}

/// The largest surface's nearest stretch of more than a few pixels is taken to lie in the first interval.
void PhaseResolver::assume_first_interval(const Surfaces& surfaces, const Grid<PixelState>& state) {
  const auto& all = evidence_.surfaces();
  const auto largest = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.size < b.size;  // the first of equals, in row-major order
  });
  SurfaceEvidence::Bins pixels{};
  for (std::size_t i = 0; i < state.size(); ++i)
    if (surfaces.root(i) == largest->root && SurfaceEvidence::representable(surfaces.wraps(i)))
      ++pixels[SurfaceEvidence::bin(surfaces.wraps(i))];
  const auto nearest = std::find_if(pixels.begin(), pixels.end(),
                                    [&](std::int32_t count) { return count > kFirstIntervalShare * largest->size; });
  if (nearest == pixels.end()) return;
  Decision& decision = decisions_[static_cast<std::size_t>(largest - all.begin())];
  decision.verdict = Verdict::anchored;
  decision.root_interval = SurfaceEvidence::kBins / 2 - static_cast<int>(nearest - pixels.begin());
}

/// A pixel whose own evidence contradicts its surface, and one beyond the intervals considered, is not mapped.
void PhaseResolver::apply(const RayTables& tables, const Surfaces& surfaces, const Grid<PixelState>& labelled,
                          Grid<PixelState>& state, Grid<float>& range_m, Grid<std::int8_t>& wraps) const {
  const FilterConfig& filter = tables.sensor->filter;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (labelled[i] != PixelState::kept) continue;
    state[i] = PixelState::ambiguous;
    const Decision& decision = decisions_[evidence_.surface_of(surfaces.root(i))];
    if (decision.verdict != Verdict::anchored) continue;
    const int interval = decision.root_interval + surfaces.wraps(i);
    const float resolved_m = range_m[i] + static_cast<float>(interval) * ambiguity;
    const int vote = evidence_.vote(i);
    if (vote != PhaseEvidence::kNoVote && vote != interval) continue;
    if (interval < PhaseEvidence::kFirstCandidate || resolved_m <= 0.0F) continue;
    if (interval > filter.max_wraps && resolved_m <= static_cast<float>(filter.range_max_m)) continue;
    state[i] = PixelState::kept;
    range_m[i] = resolved_m;
    wraps[i] = static_cast<std::int8_t>(interval);
  }
}

/// Somewhere two surfaces an interval apart were joined: try again with tight joins only; what still contradicts
/// itself stays ambiguous.
void PhaseResolver::split_contradictions(const Scene& scene, Surfaces& surfaces, Grid<PixelState>& state,
                                         Grid<float>& range_m, Grid<std::int8_t>& wraps) {
  contradictory_.assign(state.rows(), state.columns(), PixelState::ambiguous);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (labelled_[i] == PixelState::kept &&
        decisions_[evidence_.surface_of(surfaces.root(i))].verdict == Verdict::contradiction)
      contradictory_[i] = PixelState::kept;
  surfaces.label(contradictory_, scene.edges, Surfaces::Joining::tight_cores);
  evidence_.collect(scene.tables, scene.poses, scene.ground, surfaces, contradictory_, range_m);
  decisions_.clear();
  for (const SurfaceEvidence& surface : evidence_.surfaces())
    decisions_.push_back(decide(surface, scene.tables.sensor->filter));
  apply(scene.tables, surfaces, contradictory_, state, range_m, wraps);
}

}  // namespace scree
