#pragma once
// A Delaunay triangulation refined at the barycentres of its triangles.

#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// How the height of a new point follows from the three around it.
enum class BarycentreLaw {
  /// As published: the mean of the three, displaced by a variance that averages three terms as if they were
  /// independent, each clamped at 0, with the variance of (mean − vertex) taken over all triangles of a stage.
  published,
  /// The mean of the three, displaced by the exact variance of fBm less that mean.
  exact_variance,
  /// The conditional law of fBm given the three: weights and variance of kriging.
  conditional,
  /// The conditional law of fBm given the neighbours that the new point has in the triangulation (about six).
  neighbours,
};

/// A region of influence is the Voronoi cell of its centre; on a border the first of the list wins.
struct InfluenceCentre {
  double x_m = 0.0, y_m = 0.0;
  FractalLaw law;
};

struct BarycentreOptions {
  std::int64_t insertions = -1;  ///< −1: one point, sample or inserted, for each cell within the hull
  BarycentreLaw law = BarycentreLaw::published;
  /// The centres of cells themselves become the last points, instead of taking what the faces have there. Not
  /// published.
  bool insert_cell_centres = false;
  std::vector<InfluenceCentre> centres;  ///< empty: request.law everywhere
};

/// What measures best of these: neighbours, then cell centres (docs/reconstruction.md). Published, D of a realisation
/// is too small by up to .18; so corrected, it is right to .02.
inline BarycentreOptions corrected_barycentre() {
  BarycentreOptions options;
  options.law = BarycentreLaw::neighbours;
  options.insert_cell_centres = true;
  return options;
}

/// Method of the paper [DBF]. A uniformly random place chooses a triangle, so large ones come first; its barycentre
/// becomes a vertex of the Delaunay triangulation; until N are in. The places are drawn within the grid, where it and
/// the hull meet, in batches of a quarter of the points so far, each taken along a curve (the order within a batch is
/// free). All realisations share the points and differ in heights. Heights of cells are those of the faces at their
/// centres, NaN outside the hull. Samples are interpolated exactly; their variance is not used (but at repeated
/// places). iterations in the result: insertions done, fewer than asked for only where hull and grid hardly meet or a
/// barycentre no longer differs from a vertex. Errors: those of triangulate(); usage (insertions below −1 or beyond
/// kMaxInsertions, a centre whose law is none).
/// Cost: O(1) expected an insertion, docs/reconstruction.md; memory barycentre_bytes() and
/// estimate_from_realisations().
Result<SurfaceEstimate> reconstruct_barycentre(const HeightSamples& samples, const SurfaceRequest& request,
                                               const BarycentreOptions& options, Executor& executor);
inline Result<SurfaceEstimate> reconstruct_barycentre(const HeightSamples& samples, const SurfaceRequest& request,
                                                      Executor& executor) {
  return reconstruct_barycentre(samples, request, {}, executor);
}

/// Memory for so many points (samples, insertions, cell centres) without the grids, to refuse what does not fit.
inline std::int64_t barycentre_bytes(std::int64_t points, int draws) {
  return points * (100 + 8 * (draws > 8 ? draws : 8));
}

inline constexpr std::int64_t kMaxInsertions = 200'000'000;

}  // namespace scree::fractal
