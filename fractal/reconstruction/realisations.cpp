#include "fractal/reconstruction/realisations.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::fractal {
namespace {

/// Welford's update of mean and sum of squares by the n-th value, cell by cell.
void accumulate(const Grid<float>& value, int n, Grid<float>& mean, Grid<float>& squares) {
  const float weight = 1.0F / static_cast<float>(n);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const float step = value[i] - mean[i];
    mean[i] += step * weight;
    squares[i] += step * (value[i] - mean[i]);
  }
}

}  // namespace

SurfaceEstimate estimate_from_realisations(const SurfaceRequest& request, Executor& executor,
                                           const std::function<void(int, Grid<float>&)>& make) {
  const int rows = request.grid.rows, columns = request.grid.columns;
  const int total = realisation_count(request);
  const std::size_t cells = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  const int batch = cells > (1U << 22) ? 2 : 4;
  SurfaceEstimate result{Grid<float>(rows, columns, 0.0F), Grid<float>(rows, columns, 0.0F)};
  std::vector<Grid<float>> made(static_cast<std::size_t>(batch));
  for (int first = 0; first < total; first += batch) {
    const int count = std::min(batch, total - first);
    executor.for_ranges(count, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        made[static_cast<std::size_t>(i)].assign(rows, columns, NAN);
        make(first + i, made[static_cast<std::size_t>(i)]);
      }
    });
    for (int i = 0; i < count; ++i) {
      accumulate(made[static_cast<std::size_t>(i)], first + i + 1, result.mean_m, result.sd_m);
      if (first + i < request.draws && request.on_draw) request.on_draw(first + i, made[static_cast<std::size_t>(i)]);
    }
    if (request.on_progress) request.on_progress(static_cast<double>(first + count) / total);
  }
  for (float& sd : result.sd_m) sd = std::sqrt(sd / static_cast<float>(total - 1));
  return result;
}

}  // namespace scree::fractal
