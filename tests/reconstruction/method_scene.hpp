#pragma once
// A sparse scene as the methods take it.

#include <vector>

#include "fractal/reconstruction/cell_samples.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::fractal {

inline CellSamples cells_of(const Grid<float>& height_m, const Grid<float>& variance_m2) {
  CellSamples samples{height_m, variance_m2, Grid<std::uint16_t>(height_m.rows(), height_m.columns(), 0)};
  for (std::size_t i = 0; i < height_m.size(); ++i)
    if (!std::isnan(height_m[i])) samples.hits[i] = 1, ++samples.cells, ++samples.inside;
  return samples;
}
inline CellSamples cells_of(const SparseScene& scene) {
  return cells_of(scene.height, scene.variance);
}

inline SurfaceRequest request_for(const FractalLaw& law, int rows, int columns, int draws = 1) {
  SurfaceRequest request;
  request.grid = {rows, columns, kSceneCellM};
  request.law.law = law;
  request.draws = draws;
  return request;
}
inline SurfaceRequest request_for(const SparseScene& scene, int draws = 1) {
  return request_for(scene.law, scene.truth.rows(), scene.truth.columns(), draws);
}

/// Nothing measured; fill cells in.
inline CellSamples no_cells(int rows, int columns) {
  const Grid<float> nothing(rows, columns, NAN);
  return cells_of(nothing, nothing);
}
inline void measure(CellSamples& samples, int row, int column, double height_m, double variance_m2) {
  samples.height_m(row, column) = static_cast<float>(height_m);
  samples.variance_m2(row, column) = static_cast<float>(variance_m2);
  samples.hits(row, column) = 1;
  ++samples.cells, ++samples.inside;
}

/// Cuts ranges small and runs them backwards: what depends on the order shows.
class BackwardExecutor final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int end = count; end > 0; end -= 3) body(std::max(0, end - 3), end);
  }
};

inline std::vector<Grid<float>>& keep_draws(SurfaceRequest& request, std::vector<Grid<float>>& draws) {
  request.on_draw = [&draws](int, const Grid<float>& draw_m) { draws.push_back(draw_m); };
  return draws;
}

}  // namespace scree::fractal
