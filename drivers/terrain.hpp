#pragma once
// The ground of the simulated scanner: one exactly defined surface, and rays against it.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "io/raster.hpp"

namespace scree::drivers {

/// What a ray met. Distances are along the ray, in units of its direction's length (metres for a unit direction).
struct TerrainHit {
  enum class Kind : std::uint8_t {
    surface,  ///< came from above onto the surface
    nothing,  ///< left the terrain or reached the greatest distance
    beneath,  ///< found itself under the surface (through a hole, or from outside): nothing is known there
  };
  Kind kind = Kind::nothing;
  double distance_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, upward, of the patch at the hit
};

/// A height field over nodes at (x0 + column · cell_x, y0 + row · cell_y), row 0 at the smallest y. Between four finite
/// nodes the surface is their bilinear patch; a patch with a NaN corner is a hole, and there is no surface outside.
/// `truth/terrain.tif` holds the nodes (cell centres), so that anyone can recompute the surface.
/// Immutable: shared by any number of threads.
class Terrain {
 public:
  /// The cell centres of `raster` become the nodes. Errors (bad_data, naming `name`): fewer than 2 × 2 nodes, no
  /// complete patch, cells that are degrees, cell sizes that are not positive. Cost: O(cells), 4/3 · 8 bytes a cell.
  static Result<Terrain> make(io::Raster raster, const std::string& name);

  /// Height of the surface at a place of the map frame; NaN in holes and outside.
  double height_m(double x_m, double y_m) const;

  /// First meeting of the ray with the surface, exact to double rounding: a front-to-back walk of the quadtree of patch
  /// extremes, then the quadratic of ray and bilinear patch. `direction` need not be a unit vector. Cost: O(log cells)
  /// plus the patches that the ray skims.
  TerrainHit cast(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction, double max_distance_m) const;

  /// The nodes as a raster whose cells are centred on them.
  const io::Raster& raster() const { return raster_; }
  double x_min_m() const { return x0_m_; }  ///< of the outermost nodes
  double y_min_m() const { return y0_m_; }
  double x_max_m() const { return x0_m_ + (raster_.height_m.columns() - 1) * raster_.cell_m; }
  double y_max_m() const { return y0_m_ + (raster_.height_m.rows() - 1) * raster_.cell_y_m; }
  /// "x -30 … 30 m, y -30 … 30 m", for messages
  std::string extent() const;

 private:
  /// Height extremes below one quadtree node; low > high where nothing is below it.
  struct Bounds {
    float low;
    float high;
    bool complete;  ///< no hole and no outside below it
  };
  class Walk;
  Terrain() = default;
  void build_levels();
  Bounds patch_bounds(int row, int column) const;

  io::Raster raster_;
  double x0_m_ = 0.0;
  double y0_m_ = 0.0;
  std::vector<Grid<Bounds>> levels_;  ///< [0] = patches, each next one halves the shape (rounded up), to 1 × 1
};

/// How a dense survey becomes a surface (docs/simulator.md).
struct SurveyGridding {
  double cell_m = 0.0;  ///< 0 = from the point density: about 4 points a cell, rounded to 1, 2 or 5 · 10^n m
  double flat_spread_m =
      0.2;  ///< cells whose highest and lowest points differ by less hold their mean, others their top
};

/// `FILE` (a raster that GDAL reads, or points: .bin .pcd .ply .xyz .txt .csv) or
/// `fbm:D,AMPLITUDE_M,SEED[,EXTENT_M=60[,CELL_M=0.05]]`, centred on the origin of the map.
/// Errors: usage (the grammar), no_input, bad_data (not metres, no surface).
Result<Terrain> load_terrain(std::string_view specification, const SurveyGridding& gridding = {});

/// Points (rows x y z …, relative to `origin_m`) to the raster of their cells, aligned to multiples of the cell;
/// NaN where no point fell. `name` is for messages. Errors: bad_data (fewer than four points).
Result<io::Raster> grid_survey(const std::vector<Eigen::Vector4f>& points, const Eigen::Vector3d& origin_m,
                               const SurveyGridding& gridding, const std::string& name);

}  // namespace scree::drivers
