#include "fractal/reconstruction/cell_samples.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace scree::fractal {
namespace {

/// Samples sorted by cell: `order` lists them, the stretch of cell i is [first[i], first[i + 1]).
struct Buckets {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> first;
  std::size_t outside = 0;
};

Buckets sort_by_cell(const HeightSamples& samples, const SurfaceGrid& grid) {
  const auto cells = static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.columns);
  constexpr auto kOutside = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> cell(samples.size());
  Buckets buckets;
  buckets.first.assign(cells + 1, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double column = std::floor(samples.x_m[i] / grid.cell_m), row = std::floor(samples.y_m[i] / grid.cell_m);
    if (!(column >= 0 && column < grid.columns && row >= 0 && row < grid.rows)) {
      cell[i] = kOutside;
      ++buckets.outside;
      continue;
    }
    cell[i] =
        static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(grid.columns) + static_cast<std::uint32_t>(column);
    ++buckets.first[cell[i] + 1];
  }
  std::partial_sum(buckets.first.begin(), buckets.first.end(), buckets.first.begin());
  std::vector<std::uint32_t> next = buckets.first;
  buckets.order.resize(samples.size() - buckets.outside);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (cell[i] != kOutside) buckets.order[next[cell[i]]++] = static_cast<std::uint32_t>(i);
  return buckets;
}

struct Estimate {
  double height_m, variance_m2;
};

/// `indices`: the samples of one cell, whose centre is (x_m, y_m).
Estimate estimate_centre(const HeightSamples& samples, std::span<const std::uint32_t> indices, double x_m, double y_m,
                         const FractalLaw& law) {
  const auto variogram = [&law](double dx, double dy) {
    const double rms = law.rms_change_m(std::hypot(dx, dy));
    return rms * rms;
  };
  // A sample's weight: what its own noise and its distance from the centre leave of it.
  const auto weight = [&](std::uint32_t i) {
    return 1.0 / std::max(1e-30, samples.variance_m2[i] + variogram(samples.x_m[i] - x_m, samples.y_m[i] - y_m));
  };
  double sum = 0.0;
  for (const std::uint32_t i : indices) sum += weight(i);
  const auto exact = indices.first(std::min<std::size_t>(indices.size(), kExactHits));
  double exact_sum = 0.0;
  for (const std::uint32_t i : exact) exact_sum += weight(i);

  Estimate result{0.0, 0.0};
  for (const std::uint32_t i : indices) {
    const double w = weight(i) / sum;
    result.height_m += w * samples.z_m[i];
    result.variance_m2 += w * w * samples.variance_m2[i];
  }
  double ground = 0.0;
  for (const std::uint32_t i : exact) {
    const double w = weight(i) / exact_sum;
    ground += w * variogram(samples.x_m[i] - x_m, samples.y_m[i] - y_m);
    for (const std::uint32_t j : exact)
      ground -= 0.5 * w * (weight(j) / exact_sum) *
                variogram(samples.x_m[i] - samples.x_m[j], samples.y_m[i] - samples.y_m[j]);
  }
  result.variance_m2 += std::max(0.0, ground);
  return result;
}

}  // namespace

CellSamples bin_samples(const HeightSamples& samples, const SurfaceGrid& grid, const LawMap& law) {
  assert(samples.x_m.size() == samples.size() && samples.y_m.size() == samples.size());
  assert(samples.variance_m2.size() == samples.size());
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const Buckets buckets = sort_by_cell(samples, grid);
  CellSamples out{Grid<float>(grid.rows, grid.columns, kNaN), Grid<float>(grid.rows, grid.columns, kNaN),
                  Grid<std::uint16_t>(grid.rows, grid.columns, 0)};
  out.inside = buckets.order.size();
  out.outside = buckets.outside;
  for (std::size_t cell = 0; cell < out.hits.size(); ++cell) {
    const std::size_t begin = buckets.first[cell], end = buckets.first[cell + 1];
    if (begin == end) continue;
    const int row = static_cast<int>(cell / static_cast<std::size_t>(grid.columns));
    const int column = static_cast<int>(cell % static_cast<std::size_t>(grid.columns));
    const FractalLaw here = law.at(row, column);
    const Estimate centre = estimate_centre(samples, std::span(buckets.order).subspan(begin, end - begin),
                                            (column + 0.5) * grid.cell_m, (row + 0.5) * grid.cell_m, here);
    // A float surface holds a thousandth of the change over a cell at best: no datum is better than that.
    const double unit = here.rms_change_m(grid.cell_m);
    out.height_m[cell] = static_cast<float>(centre.height_m);
    out.variance_m2[cell] = static_cast<float>(std::max(centre.variance_m2, 1e-6 * unit * unit));
    out.hits[cell] = static_cast<std::uint16_t>(std::min<std::size_t>(end - begin, 65535));
    ++out.cells;
  }
  return out;
}

}  // namespace scree::fractal
