#include "node/reconstruction_grid.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string_view>

namespace scree::node {
namespace {

/// Calls `take(x_m, y_m, z_m)`, map metres, for every height of the survey.
template <class Take>
void for_each_height(const SurveyInput& survey, const Take& take) {
  if (!survey.raster) {
    for (std::size_t i = 0; i < survey.all.size(); ++i)
      take(survey.origin_m.x() + static_cast<double>(survey.all.x_m[i]),
           survey.origin_m.y() + static_cast<double>(survey.all.y_m[i]),
           survey.origin_m.z() + static_cast<double>(survey.all.z_m[i]));
    return;
  }
  const io::Raster& raster = survey.raster->raster;
  for (int r = 0; r < raster.height_m.rows(); ++r)
    for (int c = 0; c < raster.height_m.columns(); ++c)
      if (const float z = raster.height_m(r, c); std::isfinite(z))
        take(raster.x_min_m + (c + 0.5) * survey.raster->cell_x_m, raster.y_min_m + (r + 0.5) * survey.raster->cell_y_m,
             static_cast<double>(z));
}

/// The samples' box grown to whole cells of the lattice through the map's origin.
Extent box_of(const SurveyInput& survey, double cell_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for_each_height(survey, [&box](double x_m, double y_m, double) {
    box.x_min_m = std::min(box.x_min_m, x_m), box.x_max_m = std::max(box.x_max_m, x_m);
    box.y_min_m = std::min(box.y_min_m, y_m), box.y_max_m = std::max(box.y_max_m, y_m);
  });
  const auto below = [cell_m](double at_m) {
    const double cells = std::floor(at_m / cell_m);
    return cells * cell_m > at_m ? (cells - 1.0) * cell_m : cells * cell_m;
  };
  /// Whole cells from `low` until `high` lies inside the last: a sample on a border belongs to the cell above it.
  const auto above = [cell_m](double low, double high) {
    double cells = std::floor((high - low) / cell_m) + 1.0;
    while (high - low >= cells * cell_m) cells += 1.0;
    return low + cells * cell_m;
  };
  const double x_m = below(box.x_min_m), y_m = below(box.y_min_m);
  return {x_m, y_m, above(x_m, box.x_max_m), above(y_m, box.y_max_m)};
}

Extent extent_of(const SurveyRaster& survey) {
  const io::Raster& raster = survey.raster;
  return {raster.x_min_m, raster.y_min_m, raster.x_min_m + raster.height_m.columns() * survey.cell_x_m,
          raster.y_min_m + raster.height_m.rows() * survey.cell_y_m};
}

Result<fractal::SurfaceGrid> cells_of(const Extent& extent, double cell_m) {
  const double columns = (extent.x_max_m - extent.x_min_m) / cell_m, rows = (extent.y_max_m - extent.y_min_m) / cell_m;
  const double whole_columns = std::max(1.0, std::round(columns)), whole_rows = std::max(1.0, std::round(rows));
  constexpr double kRounding = 1e-6;  // of a cell, a side
  if (std::abs(columns - whole_columns) > kRounding * whole_columns ||
      std::abs(rows - whole_rows) > kRounding * whole_rows)
    return Error{ErrorKind::usage,
                 fmt::format("--extent: expected a whole number of cells of {:g} m, found {:.6g} x {:.6g}; the nearest "
                             "is --extent {},{},{},{}",
                             cell_m, columns, rows, extent.x_min_m, extent.y_min_m,
                             extent.x_min_m + whole_columns * cell_m, extent.y_min_m + whole_rows * cell_m)};
  if (whole_columns * whole_rows > kMostSurfaceCells)
    return Error{ErrorKind::bad_data,
                 fmt::format("expected at most {:.0f} cells (8192 x 8192), found {:.0f} x {:.0f}; choose larger cells, "
                             "--cell {:.3g} or more, or a smaller --extent",
                             kMostSurfaceCells, whole_columns, whole_rows,
                             cell_m * std::sqrt(whole_columns * whole_rows / kMostSurfaceCells))};
  return fractal::SurfaceGrid{static_cast<int>(whole_rows), static_cast<int>(whole_columns), cell_m};
}

/// --cell, or that of the raster.
Result<double> cell_of(const SurveyInput& survey, double cell_m) {
  if (cell_m > 0.0) return cell_m;
  if (!survey.raster) return Error{ErrorKind::usage, "--cell: expected metres for scattered points, found none"};
  if (!survey.raster->square())
    return Error{ErrorKind::bad_data, fmt::format("expected square cells, found {:.4g} m x {:.4g} m; choose: --cell",
                                                  survey.raster->cell_x_m, survey.raster->cell_y_m)};
  return survey.raster->cell_x_m;
}

void place_samples(const SurveyInput& survey, const Extent& extent, PlacedSurvey& out) {
  auto& samples = out.samples;
  const double width_m = out.grid.columns * out.grid.cell_m, height_m = out.grid.rows * out.grid.cell_m;
  for_each_height(survey, [&](double x_m, double y_m, double z_m) {
    const double x = x_m - extent.x_min_m, y = y_m - extent.y_min_m;
    if (!(x >= 0.0 && y >= 0.0 && x < width_m && y < height_m)) {
      ++out.outside;
      return;
    }
    samples.x_m.push_back(x), samples.y_m.push_back(y), samples.z_m.push_back(z_m);
  });
  samples.variance_m2.assign(samples.size(), 0.0);
}

}  // namespace

Result<Extent> parse_extent(const std::string& text) {
  std::array<double, 4> values{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), values[i]);
    const bool more = part.size() < rest.size(), last = i + 1 == values.size();
    if (status != std::errc() || end != part.data() + part.size() || !std::isfinite(values[i]) || more == last)
      return Error{ErrorKind::usage, fmt::format("--extent: expected XMIN,YMIN,XMAX,YMAX in metres, found '{}'", text)};
    if (more) rest.remove_prefix(part.size() + 1);
  }
  const Extent extent{values[0], values[1], values[2], values[3]};
  if (!(extent.x_max_m > extent.x_min_m && extent.y_max_m > extent.y_min_m))
    return Error{ErrorKind::usage,
                 fmt::format("--extent: expected XMAX above XMIN and YMAX above YMIN, found {}", text)};
  return extent;
}

Result<Grid<float>> read_at_cells(const std::string& file, const PlacedSurvey& placed) {
  const auto raster = io::read_raster(file);
  if (!raster) return raster.error();
  const auto& [rows, columns, cell_m] = placed.grid;
  Grid<float> cells(rows, columns, std::numeric_limits<float>::quiet_NaN());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double x_m = placed.place.raster.x_min_m + (c + 0.5) * cell_m;
      const double y_m = placed.place.raster.y_min_m + (r + 0.5) * cell_m;
      const double row = std::floor((y_m - raster->y_min_m) / raster->cell_y_m);
      const double column = std::floor((x_m - raster->x_min_m) / raster->cell_m);
      if (row >= 0 && row < raster->height_m.rows() && column >= 0 && column < raster->height_m.columns())
        cells(r, c) = raster->height_m(static_cast<int>(row), static_cast<int>(column));
    }
  return cells;
}

Result<PlacedSurvey> place_survey(const SurveyInput& survey, const ReconstructionGridOptions& options) {
  const auto cell_m = cell_of(survey, options.cell_m);
  if (!cell_m) return cell_m.error();
  const bool own_grid =
      survey.raster && survey.raster->square() && (options.cell_m == 0.0 || options.cell_m == survey.raster->cell_x_m);
  const Extent extent = options.extent ? *options.extent
                        : own_grid     ? extent_of(*survey.raster)
                                       : box_of(survey, *cell_m);
  const auto grid = cells_of(extent, *cell_m);
  if (!grid) return grid.error();
  PlacedSurvey out;
  out.grid = *grid;
  place_samples(survey, extent, out);
  if (out.samples.size() == 0)
    return Error{ErrorKind::bad_data,
                 fmt::format("expected samples within {:g} ... {:g} by {:g} ... {:g} m, found none ({} outside)",
                             extent.x_min_m, extent.x_max_m, extent.y_min_m, extent.y_max_m, out.outside)};
  out.place.raster = {{}, extent.x_min_m, extent.y_min_m, *cell_m, *cell_m, false, {}};
  if (survey.raster && !survey.raster->raster.geographic) out.place.raster.crs_wkt = survey.raster->raster.crs_wkt;
  out.place.picture = {extent.x_min_m, extent.y_min_m, *cell_m};
  return out;
}

}  // namespace scree::node
