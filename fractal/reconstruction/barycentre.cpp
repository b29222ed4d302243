#include "fractal/reconstruction/barycentre.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "fractal/reconstruction/barycentre_refinement.hpp"
#include "fractal/reconstruction/realisations.hpp"

namespace scree::fractal {
namespace {

Status check(const BarycentreOptions& options) {
  const auto usage = [](std::string message) { return Error{ErrorKind::usage, std::move(message)}; };
  if (options.insertions < -1 || options.insertions > kMaxInsertions)
    return usage(fmt::format("barycentre: expected 0 to {} insertions, found {}", kMaxInsertions, options.insertions));
  for (std::size_t i = 0; i < options.centres.size(); ++i) {
    const auto& [x_m, y_m, law] = options.centres[i];
    if (!std::isfinite(x_m) || !std::isfinite(y_m))
      return usage(fmt::format("influence centre {}: expected finite coordinates, found ({}, {})", i, x_m, y_m));
    if (!(law.dimension > 2.0 && law.dimension < 3.0))
      return usage(fmt::format("influence centre {}: expected 2 < D < 3, found D = {}", i, law.dimension));
    if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
      return usage(fmt::format("influence centre {}: expected a finite amplitude_m > 0, found {}", i, law.amplitude_m));
  }
  return {};
}

/// Cells within the hull less vertices on the grid.
std::int64_t missing_points(const TriangulatedSamples& surface, const SurfaceGrid& grid) {
  Grid<float> cover(grid.rows, grid.columns, NAN);
  const Delaunay& mesh = surface.mesh;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_ghost(t)) continue;
    const auto& [a, b, c] = mesh.triangle(t).vertex;
    rasterise_triangle(surface.at(a), surface.at(b), surface.at(c), cover);
  }
  std::int64_t missing = std::count_if(cover.begin(), cover.end(), [](float z) { return !std::isnan(z); });
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const PlanePoint& p = mesh.point(v);
    missing -=
        mesh.vertex_of(v) == v && p.x >= -0.5 && p.x <= grid.columns - 0.5 && p.y >= -0.5 && p.y <= grid.rows - 0.5;
  }
  return std::max<std::int64_t>(0, missing);
}

}  // namespace

Result<SurfaceEstimate> reconstruct_barycentre(const HeightSamples& samples, const SurfaceRequest& request,
                                               const BarycentreOptions& options, Executor& executor) {
  if (Status status = check(options); !status) return status.error();
  auto surface = triangulate(samples, request);
  if (!surface) return surface.error();
  const std::int64_t wanted = options.insertions >= 0 ? options.insertions : missing_points(*surface, request.grid);
  SurfaceRequest insertion = request, drawing = request;
  if (request.on_progress) {
    insertion.on_progress = [&](double share) { request.on_progress(0.7 * share); };
    drawing.on_progress = [&](double share) { request.on_progress(0.7 + 0.3 * share); };
  }
  BarycentreRefinement refinement(std::move(*surface), insertion, options, realisation_count(request));
  const std::int64_t done = refinement.refine(wanted);
  if (options.insert_cell_centres) refinement.insert_cell_centres();
  SurfaceEstimate result =
      estimate_from_realisations(drawing, executor, [&](int k, Grid<float>& out) { refinement.rasterise(k, out); });
  result.iterations = static_cast<int>(done);
  result.converged = done == wanted;
  return result;
}

}  // namespace scree::fractal
