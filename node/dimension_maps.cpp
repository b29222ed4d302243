#include "node/dimension_maps.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

#include "fractal/increments.hpp"

namespace scree::node {
namespace {

constexpr int kNarrowestWindow = 2 * fractal::kIncrementReach + 1;

template <class T>
Grid<T> rows_of(const Grid<T>& grid, int begin, int end) {
  Grid<T> part(end - begin, grid.columns());
  for (int r = begin; r < end; ++r) std::copy(grid.row(r).begin(), grid.row(r).end(), part.row(r - begin).begin());
  return part;
}

/// Rows [from, to) of `part` to where they belong.
template <class T>
void put_rows(const Grid<T>& part, int from, int to, int offset, Grid<T>& grid) {
  for (int r = from; r < to; ++r) std::copy(part.row(r).begin(), part.row(r).end(), grid.row(r + offset).begin());
}

Grid<float> as_layer(const fractal::DimensionMap& map) {
  Grid<float> flags(map.flags.rows(), map.flags.columns());
  for (std::size_t i = 0; i < flags.size(); ++i)
    flags[i] =
        std::isnan(map.dimension[i]) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(map.flags[i]);
  return flags;
}

MapsSummary summarise(const SurveyGrid& grid, const fractal::DimensionMap& map, int radius_cells) {
  MapsSummary summary{grid.cell_m, 2 * radius_cells + 1, map.dimension.rows(), map.dimension.columns()};
  std::vector<float> known;
  for (std::size_t i = 0; i < map.dimension.size(); ++i) {
    summary.known_cells += std::isfinite(grid.height_m[i]);
    summary.too_little_data += (map.flags[i] & fractal::kTooLittleData) != 0;
    summary.noise_limited += (map.flags[i] & fractal::kNoiseLimited) != 0;
    summary.not_fractal += (map.flags[i] & fractal::kNotFractal) != 0;
    summary.anisotropic += (map.flags[i] & fractal::kAnisotropic) != 0;
    summary.at_bound += (map.flags[i] & fractal::kAtBound) != 0;
    if (std::isfinite(map.dimension[i])) known.push_back(map.dimension[i]);
  }
  summary.dimension_cells = known.size();
  summary.median_dimension = std::numeric_limits<double>::quiet_NaN();
  if (known.empty()) return summary;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  summary.median_dimension = static_cast<double>(*middle);
  return summary;
}

}  // namespace

Result<int> window_radius(const SurveyGrid& grid, double window_m) {
  const double cells = window_m / grid.cell_m;
  if (!(cells > kNarrowestWindow - 1e-6))
    return Error{ErrorKind::usage,
                 fmt::format("--window-m {:g}: expected a window of at least {} cells of {:.4g} m, {:.4g} m, for the "
                             "longest increments; found {:.3g} cells",
                             window_m, kNarrowestWindow, grid.cell_m, kNarrowestWindow * grid.cell_m, cells)};
  const int widest = std::max(grid.height_m.rows(), grid.height_m.columns());
  return static_cast<int>(std::min(std::ceil(0.5 * (cells - 1.0) - 1e-6), static_cast<double>(widest)));
}

fractal::DimensionMap map_dimension(const SurveyGrid& grid, int radius_cells, Executor& executor, int strip_cells) {
  const int rows = grid.height_m.rows(), columns = grid.height_m.columns();
  fractal::DimensionMap map;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  map.dimension.assign(rows, columns, kNaN);
  map.dimension_sigma.assign(rows, columns, kNaN);
  map.amplitude_m.assign(rows, columns, kNaN);
  map.flags.assign(rows, columns, fractal::kTooLittleData);
  fractal::DimensionMapper mapper({grid.cell_m, radius_cells});
  const int reach = radius_cells + fractal::kIncrementReach;
  const int strip = std::max(2 * reach, strip_cells / columns);
  fractal::DimensionMap part;
  for (int begin = 0; begin < rows; begin += strip) {
    const int end = std::min(rows, begin + strip), first = std::max(0, begin - reach),
              last = std::min(rows, end + reach);
    mapper.update(rows_of(grid.height_m, first, last), rows_of(grid.variance_m2, first, last),
                  rows_of(grid.hits, first, last), executor, part);
    put_rows(part.dimension, begin - first, end - first, first, map.dimension);
    put_rows(part.dimension_sigma, begin - first, end - first, first, map.dimension_sigma);
    put_rows(part.amplitude_m, begin - first, end - first, first, map.amplitude_m);
    put_rows(part.flags, begin - first, end - first, first, map.flags);
  }
  return map;
}

Result<MapsSummary> write_dimension_maps(const SurveyGrid& grid, double window_m, const LayerFiles& files,
                                         Executor& executor) {
  const auto radius = window_radius(grid, window_m);
  if (!radius) return radius.error();
  const fractal::DimensionMap map = map_dimension(grid, *radius, executor);
  using io::ColourMap;
  const std::string window = fmt::format(", {:.4g} m window", (2 * *radius + 1) * grid.cell_m);
  const std::array<std::pair<const char*, io::PicturePanel>, 4> layers{
      {{"dimension", {"fractal dimension D" + window, map.dimension, {ColourMap::viridis, 2.0, 3.0, false}}},
       {"dimension_sigma",
        {"standard deviation of D" + window, map.dimension_sigma, {ColourMap::viridis, 0.0, {}, false}}},
       {"amplitude", {"rms height change at 1 m / m" + window, map.amplitude_m, {ColourMap::viridis, 0.0, {}, false}}},
       {"dimension_flags", {"flags of D (bits)", as_layer(map), {ColourMap::viridis, 0.0, 31.0, false}}}}};
  for (const auto& [name, panel] : layers)
    if (Status status = files.write(name, panel, grid.place.raster, grid.place.picture); !status) return status.error();
  return summarise(grid, map, *radius);
}

std::string maps_line(const MapsSummary& summary, const LayerFiles& files) {
  const auto share = [&](std::size_t cells) {
    return 100.0 * static_cast<double>(cells) / static_cast<double>(std::max<std::size_t>(summary.dimension_cells, 1));
  };
  if (summary.dimension_cells == 0)
    return fmt::format("{}: {} x {} cells of {:.4g} m, but no window of {} x {} holds enough neighbouring ones for a D",
                       files.file("dimension").string(), summary.columns, summary.rows, summary.cell_m,
                       summary.window_cells, summary.window_cells);
  return fmt::format(
      "{}: {} x {} cells of {:.4g} m, windows of {} x {}; D in {} cells, median {:.3f}; {:.1f} % of them "
      "noise_limited, {:.1f} % at_bound, {:.1f} % not_fractal, {:.1f} % anisotropic",
      files.file("dimension").string(), summary.columns, summary.rows, summary.cell_m, summary.window_cells,
      summary.window_cells, summary.dimension_cells, summary.median_dimension, share(summary.noise_limited),
      share(summary.at_bound), share(summary.not_fractal), share(summary.anisotropic));
}

}  // namespace scree::node
