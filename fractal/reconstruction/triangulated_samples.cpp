#include "fractal/reconstruction/triangulated_samples.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace scree::fractal {
namespace {

Error usage(std::string message) {
  return {ErrorKind::usage, std::move(message)};
}

Status check_law_map(const SurfaceRequest& request) {
  const auto& [law, dimension, amplitude_m] = request.law;
  if (!request.law.varies()) return {};
  const auto [rows, columns, cell_m] = request.grid;
  for (const Grid<float>* map : {&dimension, &amplitude_m})
    if (map->rows() != rows || map->columns() != columns)
      return usage(fmt::format("surface law: expected a map of {} x {} cells, found {} x {}", rows, columns,
                               map->rows(), map->columns()));
  for (std::size_t i = 0; i < dimension.size(); ++i)
    if (!(dimension[i] > 2.0F && dimension[i] < 3.0F && amplitude_m[i] > 0.0F && std::isfinite(amplitude_m[i])))
      return usage(fmt::format(
          "surface law: expected 2 < D < 3 and a finite amplitude_m > 0 in every cell, found {} and "
          "{} in cell {}, {}",
          dimension[i], amplitude_m[i], i / static_cast<std::size_t>(columns), i % static_cast<std::size_t>(columns)));
  return {};
}

Status check_request(const SurfaceRequest& request) {
  const auto [rows, columns, cell_m] = request.grid;
  const auto [dimension, amplitude_m] = request.law.law;
  if (rows < 1 || columns < 1)
    return usage(fmt::format("surface grid: expected at least 1 x 1 cells, found {} x {}", rows, columns));
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return usage(fmt::format("surface grid: expected a finite cell_m > 0, found {}", cell_m));
  if (request.draws < 0) return usage(fmt::format("surface draws: expected 0 or more, found {}", request.draws));
  if (!(dimension > 2.0 && dimension < 3.0))
    return usage(fmt::format("surface law: expected 2 < D < 3, found D = {}", dimension));
  if (!(amplitude_m > 0.0 && std::isfinite(amplitude_m)))
    return usage(fmt::format("surface law: expected a finite amplitude_m > 0, found {}", amplitude_m));
  return check_law_map(request);
}

Status check_samples(const HeightSamples& samples) {
  const auto bad = [](std::string message) { return Error{ErrorKind::bad_data, std::move(message)}; };
  const std::size_t count = samples.size();
  if (samples.x_m.size() != count || samples.y_m.size() != count || samples.variance_m2.size() != count)
    return bad(fmt::format("samples: expected as many x, y and variances as heights, found {}, {} and {} for {}",
                           samples.x_m.size(), samples.y_m.size(), samples.variance_m2.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(samples.z_m[i]))
      return bad(fmt::format("samples: expected finite heights, found {} at sample {}", samples.z_m[i], i));
    if (!(samples.variance_m2[i] >= 0.0 && std::isfinite(samples.variance_m2[i])))
      return bad(
          fmt::format("samples: expected finite variances >= 0, found {} at sample {}", samples.variance_m2[i], i));
  }
  return {};
}

/// Weighted mean of the heights that share a vertex.
std::vector<double> vertex_heights(const HeightSamples& samples, const Delaunay& mesh) {
  std::vector<double> z = samples.z_m;
  if (mesh.repeated() == 0) return z;
  const bool weighted =
      std::all_of(samples.variance_m2.begin(), samples.variance_m2.end(), [](double v) { return v > 0; });
  std::vector<double> weight(z.size(), 0.0), sum(z.size(), 0.0);
  for (std::size_t i = 0; i < z.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(mesh.vertex_of(static_cast<int>(i)));
    const double w = weighted ? 1.0 / samples.variance_m2[i] : 1.0;
    weight[vertex] += w;
    sum[vertex] += w * (samples.z_m[i] - samples.z_m[vertex]);  // a vertex of one sample keeps its bits
  }
  for (std::size_t i = 0; i < z.size(); ++i)
    if (weight[i] > 0.0) z[i] += sum[i] / weight[i];
  return z;
}

}  // namespace

Result<TriangulatedSamples> triangulate(const HeightSamples& samples, const SurfaceRequest& request) {
  if (Status status = check_request(request); !status) return status.error();
  if (Status status = check_samples(samples); !status) return status.error();
  std::vector<double> x(samples.size()), y(samples.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = samples.x_m[i] / request.grid.cell_m - 0.5;
    y[i] = samples.y_m[i] / request.grid.cell_m - 0.5;
  }
  auto mesh = Delaunay::make(x, y);
  if (!mesh) return mesh.error();
  std::vector<double> z = vertex_heights(samples, *mesh);
  return TriangulatedSamples{std::move(*mesh), std::move(z)};
}

FractalLaw law_at(const SurfaceRequest& request, double x, double y) {
  if (!request.law.varies()) return request.law.law;
  const auto nearest = [](double at, int count) {
    return static_cast<int>(std::lround(std::clamp(at, 0.0, count - 1.0)));
  };
  return request.law.at(nearest(y, request.grid.rows), nearest(x, request.grid.columns));
}

}  // namespace scree::fractal
