#include "fractal/reconstruction/draw_spread.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::fractal {

Grid<float> spread_of_draws(const SurfaceRequest& request, const Grid<float>& mean_m, const MakeDraw& make,
                            Executor& executor) {
  const int count = std::max(request.draws, kMinSpreadDraws);
  Grid<float> spread(mean_m.rows(), mean_m.columns(), 0.0F);
  std::vector<Grid<float>> batch(kDrawBatch, Grid<float>(mean_m.rows(), mean_m.columns()));
  for (int first = 0; first < count; first += kDrawBatch) {
    const int here = std::min(kDrawBatch, count - first);
    executor.for_ranges(here, [&](int begin, int end) {
      for (int k = begin; k < end; ++k) make(first + k, batch[static_cast<std::size_t>(k)]);
    });
    for (int k = 0; k < here; ++k) {
      const Grid<float>& draw = batch[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < spread.size(); ++i) spread[i] += (draw[i] - mean_m[i]) * (draw[i] - mean_m[i]);
      if (first + k < request.draws && request.on_draw) request.on_draw(first + k, draw);
    }
    if (request.on_progress) request.on_progress(static_cast<double>(first + here) / count);
  }
  for (float& value : spread) value = std::sqrt(value / static_cast<float>(count));
  return spread;
}

}  // namespace scree::fractal
