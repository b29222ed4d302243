#pragma once
// A polyhedron over scattered heights whose edges are broken again and again.

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

struct PolyhedronOptions {
  int iterations = 0;          ///< 0: until no edge is as long as shortest_edge_m
  double shortest_edge_m = 0;  ///< edges below this stay whole; 0: one cell
};

/// [XZ00]: triangulate the samples (Delaunay; the paper leaves it open); an iteration splits every edge once, raising
/// its midpoint by √(1 − 2^(2H−2))·‖Δ‖^H·σ·G in z alone, so that a triangle becomes four; triangles on both sides of
/// an edge share its midpoint. ‖Δ‖, "the least sampling distance", is half the edge: the distance between the points
/// after the split, for which the factor is the exact sd of fBm between two known ends. An edge below the threshold
/// stays whole, and its triangle becomes three or two. Heights of cells are those of the faces at their centres, NaN
/// outside the hull of the samples. Samples are interpolated exactly, their variance is not used (but at repeated
/// places, triangulated_samples.hpp). iterations in the result: those done. Errors: those of triangulate(); usage (a
/// negative option). Cost: about 100 ns a face, some six faces a cell, each realisation; memory as
/// estimate_from_realisations().
Result<SurfaceEstimate> reconstruct_polyhedron(const HeightSamples& samples, const SurfaceRequest& request,
                                               const PolyhedronOptions& options, Executor& executor);
inline Result<SurfaceEstimate> reconstruct_polyhedron(const HeightSamples& samples, const SurfaceRequest& request,
                                                      Executor& executor) {
  return reconstruct_polyhedron(samples, request, {}, executor);
}

}  // namespace scree::fractal
