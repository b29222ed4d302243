#pragma once
// Which ambiguity interval a return comes from. docs/perceptron.md explains the rule and where it fails.

#include <cstdint>
#include <vector>

#include "drivers/frame/image_edges.hpp"
#include "drivers/frame/phase_evidence.hpp"

namespace scree {

/// Relative intervals inside a surface come from continuity (Surfaces), the absolute one from its pixels' votes.
class PhaseResolver {
 public:
  struct Scene {
    const RayTables& tables;
    const RowPoses& poses;
    const GroundLookup& ground;
    const ImageEdges& edges;
  };

  /// Adds the intervals to the kept pixels of `range_m` and stores them in `wraps`; pixels whose interval cannot be
  /// told become `ambiguous`. `surfaces` is labelled by cores over the kept pixels on entry and is used up.
  /// Returns true when the first interval was assumed (PhasePolicy::first_interval).
  bool resolve(const Scene& scene, Surfaces& surfaces, Grid<PixelState>& state, Grid<float>& range_m,
               Grid<std::int8_t>& wraps);

 private:
  enum class Verdict : std::uint8_t { anchored, no_evidence, contradiction };
  struct Decision {
    Verdict verdict = Verdict::no_evidence;
    int root_interval = 0;
  };

  static Decision decide(const SurfaceEvidence& evidence, const FilterConfig& filter);
  bool any(Verdict verdict) const;
  void assume_first_interval(const Surfaces& surfaces, const Grid<PixelState>& state);
  void apply(const RayTables& tables, const Surfaces& surfaces, const Grid<PixelState>& labelled,
             Grid<PixelState>& state, Grid<float>& range_m, Grid<std::int8_t>& wraps) const;
  void split_contradictions(const Scene& scene, Surfaces& surfaces, Grid<PixelState>& state, Grid<float>& range_m,
                            Grid<std::int8_t>& wraps);

  PhaseEvidence evidence_;
  std::vector<Decision> decisions_;  ///< one per surface of evidence_
  Grid<PixelState> labelled_;        ///< the pixels a labelling was made of
  Grid<PixelState> contradictory_;   ///< kept where a surface contradicts itself
};

}  // namespace scree
