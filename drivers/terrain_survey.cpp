#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>

#include "drivers/terrain_load.hpp"

namespace scree::drivers {
namespace {

constexpr double kPointsPerCell = 4.0;
constexpr double kMostCells = 0x1p28;

struct Box {
  double x_min = 0, x_max = 0, y_min = 0, y_max = 0;
};

Box box_of(const std::vector<Eigen::Vector4f>& points) {
  Box box{points[0].x(), points[0].x(), points[0].y(), points[0].y()};
  for (const auto& p : points) {
    box.x_min = std::min<double>(box.x_min, p.x());
    box.x_max = std::max<double>(box.x_max, p.x());
    box.y_min = std::min<double>(box.y_min, p.y());
    box.y_max = std::max<double>(box.y_max, p.y());
  }
  return box;
}

/// Rounds in the logarithm to 1, 2 or 5 times a power of ten.
double round_length(double length) {
  const double decade = std::pow(10.0, std::floor(std::log10(length)));
  const double mantissa = length / decade;
  return decade * (mantissa < std::sqrt(2.0)    ? 1.0
                   : mantissa < std::sqrt(10.0) ? 2.0
                   : mantissa < std::sqrt(50.0) ? 5.0
                                                : 10.0);
}

struct Cell {
  double sum = 0.0;
  std::uint32_t count = 0;
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

}  // namespace

double survey_cell_m(const std::vector<Eigen::Vector4f>& points) {
  const Box box = box_of(points);
  const double width = std::max(box.x_max - box.x_min, 1e-3), height = std::max(box.y_max - box.y_min, 1e-3);
  // Coarse cells of about 100 points each if the survey were even; the empty ones say nothing about its density.
  const double coarse = std::sqrt(width * height * 100.0 / static_cast<double>(points.size()));
  const auto columns = static_cast<std::size_t>(width / coarse) + 1,
             rows = static_cast<std::size_t>(height / coarse) + 1;
  std::vector<std::uint32_t> counts(rows * columns, 0);
  for (const auto& p : points)
    ++counts[static_cast<std::size_t>((p.y() - box.y_min) / coarse) * columns +
             static_cast<std::size_t>((p.x() - box.x_min) / coarse)];
  std::erase(counts, 0U);
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return round_length(coarse * std::sqrt(kPointsPerCell / *middle));
}

Result<io::Raster> grid_survey(const std::vector<Eigen::Vector4f>& points, const Eigen::Vector3d& origin_m,
                               const SurveyGridding& gridding, const std::string& name) {
  if (points.size() < 4)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected at least 4 points, found {}", name, points.size())};
  const double cell = gridding.cell_m > 0.0 ? gridding.cell_m : survey_cell_m(points);
  const Box box = box_of(points);
  // Cells start at multiples of their size in the map frame, as the map's own do.
  const double first_column = std::floor((box.x_min + origin_m.x()) / cell);
  const double first_row = std::floor((box.y_min + origin_m.y()) / cell);
  const double columns = std::floor((box.x_max + origin_m.x()) / cell) - first_column + 1;
  const double rows = std::floor((box.y_max + origin_m.y()) / cell) - first_row + 1;
  if (!(rows * columns <= kMostCells))
    return Error{ErrorKind::bad_data, fmt::format("{}: expected a survey of at most 2^28 cells, found {} × {} of {} m",
                                                  name, rows, columns, cell)};
  Grid<Cell> cells(static_cast<int>(rows), static_cast<int>(columns));
  for (const auto& p : points) {
    Cell& cell_of = cells(static_cast<int>(std::floor((p.y() + origin_m.y()) / cell) - first_row),
                          static_cast<int>(std::floor((p.x() + origin_m.x()) / cell) - first_column));
    cell_of.sum += p.z();
    ++cell_of.count;
    cell_of.low = std::min(cell_of.low, p.z());
    cell_of.high = std::max(cell_of.high, p.z());
  }
  io::Raster raster;
  raster.cell_m = raster.cell_y_m = cell;
  raster.x_min_m = first_column * cell;
  raster.y_min_m = first_row * cell;
  raster.height_m.assign(cells.rows(), cells.columns(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& c = cells[i];
    if (c.count == 0) continue;
    const bool flat = c.high - c.low < gridding.flat_spread_m;
    raster.height_m[i] = static_cast<float>((flat ? c.sum / c.count : c.high) + origin_m.z());
  }
  return raster;
}

}  // namespace scree::drivers
