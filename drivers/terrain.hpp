#pragma once
// The ground of the simulated scanner: one exactly defined surface, and rays against it.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
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

/// A height field over nodes at (x_min + column · cell_m, y_min + row · cell_y_m), row 0 at the smallest y. Between
/// four finite nodes the surface is their bilinear patch; a patch with a NaN corner is a hole, and there is no surface
/// outside. `truth/terrain.tif` holds the nodes (cell centres), so that anyone can recompute the surface.
/// Immutable: shared by any number of threads.
class Terrain {
 public:
  /// The cell centres of `raster` become the nodes. Errors (bad_data, naming `name`): cells that are degrees or not
  /// positive, fewer than 2 × 2 nodes, no complete patch. Cost: O(cells); 4 bytes a cell beside the raster itself.
  static Result<Terrain> make(io::Raster raster, const std::string& name);

  /// Height of the surface at a place of the map frame; NaN in holes and outside.
  double height_m(double x_m, double y_m) const;

  /// First meeting of the ray with the surface, exact to double rounding: a front-to-back walk of the quadtree of patch
  /// extremes, then the quadratic of ray and bilinear patch. `direction` need not be a unit vector, must not be zero.
  /// A hit within kSkin_m above its patch counts as on it. Cost: O(log cells) plus the patches that the ray skims.
  TerrainHit cast(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction, double max_distance_m) const;

  /// The nodes as a raster whose cells are centred on them.
  const io::Raster& raster() const { return raster_; }
  /// Extent of the nodes.
  double x_min_m() const { return raster_.x_min_m + 0.5 * raster_.cell_m; }
  double y_min_m() const { return raster_.y_min_m + 0.5 * raster_.cell_y_m; }
  double x_max_m() const { return x_min_m() + (raster_.height_m.columns() - 1) * raster_.cell_m; }
  double y_max_m() const { return y_min_m() + (raster_.height_m.rows() - 1) * raster_.cell_y_m; }
  /// "x -30 … 30 m, y -30 … 30 m", for messages
  std::string extent() const;

  /// Rounding that a ray may lie beneath a patch where it crosses from the neighbouring one.
  static constexpr double kSkin_m = 1e-7;

 private:
  /// Height extremes below one quadtree node; low > high where nothing is below it.
  struct Bounds {
    float low;
    float high;
    bool complete;  ///< neither hole nor outside below it
  };
  class Walk;
  Terrain() = default;
  void build_levels();
  /// In the header for the sake of Walk: a tenth of the time of a ray.
  Bounds patch_bounds(int row, int column) const {
    const auto& z = raster_.height_m;
    if (row + 1 >= z.rows() || column + 1 >= z.columns()) return {kInfinity, -kInfinity, false};
    const float a = z(row, column), b = z(row, column + 1), c = z(row + 1, column), d = z(row + 1, column + 1);
    if (std::isnan(a + b + c + d)) return {kInfinity, -kInfinity, false};
    return {std::min(std::min(a, b), std::min(c, d)), std::max(std::max(a, b), std::max(c, d)), true};
  }
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  io::Raster raster_;
  std::vector<Grid<Bounds>> levels_;  ///< [k]: nodes of 2^(k+1) × 2^(k+1) patches, up to 1 × 1 nodes
};

}  // namespace scree::drivers
