#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drivers/terrain.hpp"

namespace scree::drivers {

/// One ray's way down the quadtree. Plane coordinates are in cells: patch (row, column) is [column, column+1] ×
/// [row, row+1]. Neighbouring nodes share the ray parameters of their common border, so nothing falls between them.
class Terrain::Walk {
 public:
  Walk(const Terrain& terrain, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction)
      : terrain_(terrain),
        u_((origin_m.x() - terrain.x_min_m()) / terrain.raster_.cell_m),
        v_((origin_m.y() - terrain.y_min_m()) / terrain.raster_.cell_y_m),
        z_m_(origin_m.z()),
        du_(direction.x() / terrain.raster_.cell_m),
        dv_(direction.y() / terrain.raster_.cell_y_m),
        dz_m_(direction.z()),
        per_du_(1.0 / du_),
        per_dv_(1.0 / dv_) {}

  TerrainHit run(double max_distance_m) {
    double enter = 0.0, leave = max_distance_m;
    if (!clip(u_, du_, terrain_.raster_.height_m.columns() - 1, enter, leave)) return {};
    if (!clip(v_, dv_, terrain_.raster_.height_m.rows() - 1, enter, leave)) return {};
    push({static_cast<int>(terrain_.levels_.size()), 0, 0, enter, leave});
    while (depth_ > 0 && !done_) visit(stack_[static_cast<std::size_t>(--depth_)]);
    return hit_;
  }

 private:
  struct Node {
    int level;  ///< 0 = a patch
    int row, column;
    double enter, leave;  ///< ray parameters
  };

  static bool clip(double start, double slope, double end, double& enter, double& leave) {
    if (slope == 0.0) return start >= 0.0 && start <= end;
    const double a = -start / slope, b = (end - start) / slope;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
    return enter <= leave;
  }

  void push(const Node& node) { stack_[static_cast<std::size_t>(depth_++)] = node; }

  void end(TerrainHit::Kind kind, double t, const Eigen::Vector3d& normal) {
    done_ = true;
    hit_ = {kind, t, normal};
  }

  Bounds bounds(const Node& node) const {
    if (node.level == 0) return terrain_.patch_bounds(node.row, node.column);
    const auto& level = terrain_.levels_[static_cast<std::size_t>(node.level - 1)];
    if (node.row >= level.rows() || node.column >= level.columns()) return {kInfinity, -kInfinity, false};
    return level(node.row, node.column);
  }

  void visit(const Node& node) {
    const Bounds below = bounds(node);
    const double z0 = z_m_ + dz_m_ * node.enter, z1 = z_m_ + dz_m_ * node.leave;
    if (std::min(z0, z1) > below.high) return;  // over it, or nothing there
    if (std::max(z0, z1) < below.low - kSkin_m && below.complete)
      return end(TerrainHit::Kind::beneath, node.enter, Eigen::Vector3d::UnitZ());
    if (node.level == 0)
      meet_patch(node);
    else
      descend(node);
  }

  /// Pushes the (at most three) children that the ray crosses, the farthest first.
  void descend(const Node& node) {
    const int half = 1 << (node.level - 1);
    const double u_middle = (2.0 * node.column + 1.0) * half, v_middle = (2.0 * node.row + 1.0) * half;
    // The ray parameter of the change to the other half, or none.
    constexpr double kNever = std::numeric_limits<double>::infinity();
    double u_cross = du_ == 0.0 ? kNever : (u_middle - u_) * per_du_;
    double v_cross = dv_ == 0.0 ? kNever : (v_middle - v_) * per_dv_;
    int u_side = du_ == 0.0 ? (u_ >= u_middle) : ((node.enter < u_cross) == (du_ < 0.0));
    int v_side = dv_ == 0.0 ? (v_ >= v_middle) : ((node.enter < v_cross) == (dv_ < 0.0));
    if (u_cross <= node.enter) u_cross = kNever;
    if (v_cross <= node.enter) v_cross = kNever;

    std::array<Node, 3> children;
    std::size_t count = 0;
    double t = node.enter;
    while (true) {
      const double next = std::min({u_cross, v_cross, node.leave});
      children[count++] = {node.level - 1, 2 * node.row + v_side, 2 * node.column + u_side, t, next};
      if (next >= node.leave || count == children.size()) break;
      if (u_cross == next) u_side ^= 1, u_cross = kNever;
      if (v_cross == next) v_side ^= 1, v_cross = kNever;
      t = next;
    }
    while (count > 0) push(children[--count]);
  }

  /// Height of the ray over the patch at t = enter + s: a·s² + b·s + c.
  void meet_patch(const Node& node) {
    const auto& z = terrain_.raster_.height_m;
    const double h00 = z(node.row, node.column), h01 = z(node.row, node.column + 1);
    const double h10 = z(node.row + 1, node.column), h11 = z(node.row + 1, node.column + 1);
    const double twist = h00 - h01 - h10 + h11, rise_u = h01 - h00, rise_v = h10 - h00;
    const double u = u_ + du_ * node.enter - node.column, v = v_ + dv_ * node.enter - node.row;
    const double a = -twist * du_ * dv_;
    const double b = dz_m_ - (rise_u + twist * v) * du_ - (rise_v + twist * u) * dv_;
    const double c = z_m_ + dz_m_ * node.enter - (h00 + rise_u * u + rise_v * v + twist * u * v);
    if (c < -kSkin_m) return end(TerrainHit::Kind::beneath, node.enter, Eigen::Vector3d::UnitZ());
    const double s = c <= 0.0 ? 0.0 : first_root(a, b, c);
    if (!(s <= node.leave - node.enter)) return;
    const double u_hit = u + du_ * s, v_hit = v + dv_ * s;
    const Eigen::Vector3d normal(-(rise_u + twist * v_hit) / terrain_.raster_.cell_m,
                                 -(rise_v + twist * u_hit) / terrain_.raster_.cell_y_m, 1.0);
    end(TerrainHit::Kind::surface, node.enter + s, normal.normalized());
  }

  /// The smallest s > 0 with a·s² + b·s + c = 0 for c > 0, NaN if there is none; without cancellation.
  static double first_root(double a, double b, double c) {
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0 || (b >= 0.0 && a >= 0.0)) return std::numeric_limits<double>::quiet_NaN();
    const double root = std::sqrt(discriminant);
    return b < 0.0 ? 2.0 * c / (root - b) : (b + root) / (-2.0 * a);
  }

  const Terrain& terrain_;
  double u_, v_, z_m_;
  double du_, dv_, dz_m_;
  double per_du_, per_dv_;       ///< infinite where the ray does not move that way
  std::array<Node, 128> stack_;  // two more a level, at most 31 levels
  int depth_ = 0;
  bool done_ = false;
  TerrainHit hit_;
};

TerrainHit Terrain::cast(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                         double max_distance_m) const {
  return Walk(*this, origin_m, direction).run(max_distance_m);
}

}  // namespace scree::drivers
