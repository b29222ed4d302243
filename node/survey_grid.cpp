#include "node/survey_grid.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

#include "fractal/cell_centres.hpp"

namespace scree::node {
namespace {

constexpr double kMostCells = 1 << 25;

Result<SurveyGrid> from_raster(const SurveyRaster& survey, const GriddingOptions& options) {
  if (options.cell_m > 0.0)
    return Error{ErrorKind::usage, "--cell-m: expected scattered points, found a raster, which has cells of its own"};
  const io::Raster& raster = survey.raster;
  if (!survey.square())
    return Error{
        ErrorKind::bad_data,
        fmt::format("expected square cells for what looks along rows and columns alike, found {:.4g} m x {:.4g} "
                    "m; reproject first: gdalwarp -t_srs EPSG:326NN -tr {:.0f} {:.0f} -r bilinear IN OUT.tif",
                    survey.cell_x_m, survey.cell_y_m, survey.cell_y_m, survey.cell_y_m)};
  const int rows = raster.height_m.rows(), columns = raster.height_m.columns();
  if (static_cast<double>(rows) * columns > kMostCells)
    return Error{ErrorKind::bad_data, fmt::format("expected at most {:.0f} cells, found {} x {}; cut the raster or "
                                                  "average it first: gdalwarp -r average",
                                                  kMostCells, rows, columns)};
  SurveyGrid grid;
  grid.cell_m = std::sqrt(survey.cell_x_m * survey.cell_y_m);
  grid.height_m = raster.height_m;
  grid.variance_m2.assign(rows, columns, static_cast<float>(options.noise_sigma_m * options.noise_sigma_m));
  grid.hits.assign(rows, columns, 0);
  grid.place.raster = {
      {}, raster.x_min_m, raster.y_min_m, raster.cell_m, raster.cell_y_m, raster.geographic, raster.crs_wkt};
  grid.place.picture = raster.geographic ? io::PictureFrame{0.0, 0.0, grid.cell_m}
                                         : io::PictureFrame{raster.x_min_m, raster.y_min_m, grid.cell_m};
  return grid;
}

/// Sums over the points of each cell: offsets from its centre in cells, heights above the first point.
struct CellSums {
  Grid<double> dx, dy, z;
  Grid<std::uint32_t> count;

  CellSums(int rows, int columns) : dx(rows, columns), dy(rows, columns), z(rows, columns), count(rows, columns) {}
};

struct Lattice {
  CellIndex min;
  int rows = 0, columns = 0;
};

Result<Lattice> lattice_around(const SurveyInput& survey, double cell_m) {
  const auto bounds = [cell_m](const std::vector<float>& values, double origin_m) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return std::pair(std::floor((static_cast<double>(*low) + origin_m) / cell_m),
                     std::floor((static_cast<double>(*high) + origin_m) / cell_m));
  };
  const auto x = bounds(survey.all.x_m, survey.origin_m.x()), y = bounds(survey.all.y_m, survey.origin_m.y());
  const double columns = x.second - x.first + 1, rows = y.second - y.first + 1;
  constexpr double kFarthest = 1 << 30;
  if (!(rows * columns <= kMostCells) ||
      std::max({std::abs(x.first), std::abs(x.second), std::abs(y.first), std::abs(y.second)}) > kFarthest)
    return Error{ErrorKind::bad_data,
                 fmt::format("cells of {:.4g} m: expected a grid of at most {:.0f}, found {:.0f} x {:.0f}; choose "
                             "larger ones: --cell-m",
                             cell_m, kMostCells, rows, columns)};
  return Lattice{{static_cast<std::int32_t>(x.first), static_cast<std::int32_t>(y.first)},
                 static_cast<int>(rows),
                 static_cast<int>(columns)};
}

CellSums sum_cells(const SurveyInput& survey, const Lattice& lattice, double cell_m) {
  CellSums sums(lattice.rows, lattice.columns);
  const double z0 = static_cast<double>(survey.all.z_m.front());
  for (std::size_t i = 0; i < survey.all.size(); ++i) {
    const double x = (static_cast<double>(survey.all.x_m[i]) + survey.origin_m.x()) / cell_m;
    const double y = (static_cast<double>(survey.all.y_m[i]) + survey.origin_m.y()) / cell_m;
    const double column = std::floor(x), row = std::floor(y);
    const int c = static_cast<int>(column - lattice.min.x), r = static_cast<int>(row - lattice.min.y);
    sums.dx(r, c) += x - column - 0.5;
    sums.dy(r, c) += y - row - 0.5;
    sums.z(r, c) += static_cast<double>(survey.all.z_m[i]) - z0;
    ++sums.count(r, c);
  }
  return sums;
}

Result<SurveyGrid> from_points(const SurveyInput& survey, const GriddingOptions& options) {
  SurveyGrid grid;
  grid.cell_m = options.cell_m > 0.0 ? options.cell_m : options.spacing_m;
  const auto lattice = lattice_around(survey, grid.cell_m);
  if (!lattice) return lattice.error();
  const CellSums sums = sum_cells(survey, *lattice, grid.cell_m);
  const int rows = lattice->rows, columns = lattice->columns;
  grid.height_m.assign(rows, columns, std::numeric_limits<float>::quiet_NaN());
  grid.variance_m2.assign(rows, columns, 0.0F);
  grid.hits.assign(rows, columns, 0);
  Grid<float> dx(rows, columns), dy(rows, columns);
  for (std::size_t i = 0; i < grid.height_m.size(); ++i) {
    if (sums.count[i] == 0) continue;
    const double count = sums.count[i];
    grid.height_m[i] = static_cast<float>(sums.z[i] / count);
    grid.variance_m2[i] = static_cast<float>(options.noise_sigma_m * options.noise_sigma_m / count);
    grid.hits[i] = static_cast<std::uint16_t>(std::min(count, 65535.0));
    dx[i] = static_cast<float>(sums.dx[i] / count), dy[i] = static_cast<float>(sums.dy[i] / count);
  }
  fractal::move_to_centres(dx, dy, options.level_radius_cells, grid.height_m);
  const double x_min_m = lattice->min.x * grid.cell_m, y_min_m = lattice->min.y * grid.cell_m;
  grid.place.raster = {{}, x_min_m, y_min_m, grid.cell_m, grid.cell_m, false};
  grid.place.picture = {x_min_m, y_min_m, grid.cell_m};
  return grid;
}

}  // namespace

Result<SurveyGrid> grid_survey(const SurveyInput& survey, const GriddingOptions& options) {
  return survey.raster ? from_raster(*survey.raster, options) : from_points(survey, options);
}

}  // namespace scree::node
