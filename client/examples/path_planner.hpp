#pragma once
// The example planner: A* over a grid of received costs, and a pure-pursuit follower. C++17, standard library only, to
// be copied. MIT licence, as the rest of Scree.
//
//   PathPlanner planner(rules);
//   const Path path = planner.plan(grid, start, goal);      // again whenever the map changes: some ms for 400 x 400
//   const Drive drive = follow(path, pose, follower_rules); // at the rate of control

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace scree_example {

constexpr std::uint8_t kLethal = 254, kUnknown = 255;

struct Point {
  double x_m = 0.0, y_m = 0.0;
};

inline double distance_m(const Point& a, const Point& b) {
  return std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
}

/// Costs as the map protocol has them, row 0 at the smallest y. Cells: [x_min + i cell, + cell).
struct CostGrid {
  int columns = 0, rows = 0;
  double cell_m = 0.1, x_min_m = 0.0, y_min_m = 0.0;
  std::vector<std::uint8_t> cost;

  int column_of(double x_m) const { return static_cast<int>(std::floor((x_m - x_min_m) / cell_m)); }
  int row_of(double y_m) const { return static_cast<int>(std::floor((y_m - y_min_m) / cell_m)); }
  bool contains(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  Point centre(std::size_t index) const {
    const auto n = static_cast<std::size_t>(columns);
    return {x_min_m + (static_cast<double>(index % n) + 0.5) * cell_m,
            y_min_m + (static_cast<double>(index / n) + 0.5) * cell_m};
  }
};

/// The cells of `window`, whose corner lies on the lattice of cells, in a grid that holds the box of `a` and `b` with
/// `margin_m` around it; what the window does not hold is unknown. `out` keeps its memory.
inline void cut_to_box(const CostGrid& window, const Point& a, const Point& b, double margin_m, CostGrid& out) {
  const double cell_m = window.cell_m;
  const auto lower = [&](double p, double q) {
    return static_cast<int>(std::floor((std::min(p, q) - margin_m) / cell_m));
  };
  const auto upper = [&](double p, double q) {
    return static_cast<int>(std::ceil((std::max(p, q) + margin_m) / cell_m));
  };
  const int left = lower(a.x_m, b.x_m), bottom = lower(a.y_m, b.y_m);
  out.cell_m = cell_m;
  out.x_min_m = left * cell_m;
  out.y_min_m = bottom * cell_m;
  out.columns = upper(a.x_m, b.x_m) - left;
  out.rows = upper(a.y_m, b.y_m) - bottom;
  out.cost.assign(static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows), kUnknown);
  const int right_by = static_cast<int>(std::lround(window.x_min_m / cell_m)) - left;
  const int up_by = static_cast<int>(std::lround(window.y_min_m / cell_m)) - bottom;
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column)
      if (out.contains(column + right_by, row + up_by))
        out.cost[out.index(column + right_by, row + up_by)] = window.cost[window.index(column, row)];
}

struct PlanRules {
  /// A metre over cost c counts as 1 + cost_weight * c / 252 metres.
  double cost_weight = 6.0;
  /// Unknown ground: forbidden, or entered at this cost. A robot that sees only what is near must enter some: it
  /// replans as the map comes. 253 is "for the planner's own use": nobody sends it; it is entered at its own price.
  bool enter_unknown = true;
  double unknown_cost = 200.0;
  /// Where the vehicle already stands it can stand: if the cell it stands on is forbidden, it may leave over forbidden
  /// cells within this distance, at the price of unknown_cost.
  double start_radius_m = 1.0;
};

struct Path {
  bool found = false;
  std::vector<Point> points;  ///< centres of cells from the start's to the goal's, and the goal
  double length_m = 0.0;
  double price_m = 0.0;  ///< metres with costs in them; what A* made least
};

/// A* with eight neighbours and the octile distance for a heuristic. Exact: no path is cheaper. Keeps its buffers; does
/// not allocate once they fit the grid. A diagonal step must not touch a forbidden cell on either side. The least
/// price of a metre is 1, so the heuristic never over-estimates.
class PathPlanner {
 public:
  explicit PathPlanner(PlanRules rules = {}) : rules_(rules) {}

  Path plan(const CostGrid& grid, const Point& start, const Point& goal) {
    const int c0 = grid.column_of(start.x_m), r0 = grid.row_of(start.y_m);
    const int c1 = grid.column_of(goal.x_m), r1 = grid.row_of(goal.y_m);
    if (!grid.contains(c0, r0) || !grid.contains(c1, r1)) return {};
    const std::size_t from = grid.index(c0, r0), to = grid.index(c1, r1);
    weigh(grid, from);
    weight_[from] = std::min(weight_[from], weight_of(rules_.unknown_cost));
    if (!std::isfinite(weight_[to]) || !search(grid, from, to)) return {};
    Path path = collect(grid, from, to);
    path.points.push_back(goal);  // the last cell's centre is only near it
    return path;
  }

 private:
  struct Node {
    double bound_m;  ///< price so far + heuristic
    std::size_t cell;
    bool operator>(const Node& other) const {
      return bound_m != other.bound_m ? bound_m > other.bound_m : cell > other.cell;
    }
  };
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  double weight_of(double cost) const { return 1.0 + rules_.cost_weight * cost / 252.0; }

  void weigh(const CostGrid& grid, std::size_t from) {
    const double forbidden = std::numeric_limits<double>::infinity();
    weight_.resize(grid.cost.size());
    for (std::size_t i = 0; i < grid.cost.size(); ++i) {
      const std::uint8_t cost = grid.cost[i];
      weight_[i] = cost < kLethal                             ? weight_of(cost)
                   : cost == kUnknown && rules_.enter_unknown ? weight_of(rules_.unknown_cost)
                                                              : forbidden;
    }
    if (std::isfinite(weight_[from])) return;
    for (std::size_t i = 0; i < grid.cost.size(); ++i)
      if (!std::isfinite(weight_[i]) && distance_m(grid.centre(i), grid.centre(from)) <= rules_.start_radius_m)
        weight_[i] = weight_of(rules_.unknown_cost);
  }

  bool search(const CostGrid& grid, std::size_t from, std::size_t to) {
    price_m_.assign(grid.cost.size(), std::numeric_limits<double>::infinity());
    parent_.assign(grid.cost.size(), kNone);
    open_.clear();
    price_m_[from] = 0.0;
    open_.push_back({heuristic_m(grid, from, to), from});
    while (!open_.empty()) {
      std::pop_heap(open_.begin(), open_.end(), std::greater<>());
      const Node node = open_.back();
      open_.pop_back();
      if (node.cell == to) return true;
      if (node.bound_m > price_m_[node.cell] + heuristic_m(grid, node.cell, to)) continue;  // an older, dearer entry
      expand(grid, node.cell, to);
    }
    return false;
  }

  void expand(const CostGrid& grid, std::size_t cell, std::size_t to) {
    const int column = static_cast<int>(cell % static_cast<std::size_t>(grid.columns));
    const int row = static_cast<int>(cell / static_cast<std::size_t>(grid.columns));
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        if ((dr == 0 && dc == 0) || !grid.contains(column + dc, row + dr)) continue;
        const std::size_t next = grid.index(column + dc, row + dr);
        if (!std::isfinite(weight_[next])) continue;
        const bool diagonal = dr != 0 && dc != 0;
        if (diagonal && (!std::isfinite(weight_[grid.index(column + dc, row)]) ||
                         !std::isfinite(weight_[grid.index(column, row + dr)])))
          continue;
        const double step_m = grid.cell_m * (diagonal ? std::sqrt(2.0) : 1.0);
        const double price_m = price_m_[cell] + 0.5 * step_m * (weight_[cell] + weight_[next]);
        if (price_m >= price_m_[next]) continue;
        price_m_[next] = price_m;
        parent_[next] = cell;
        open_.push_back({price_m + heuristic_m(grid, next, to), next});
        std::push_heap(open_.begin(), open_.end(), std::greater<>());
      }
  }

  static double heuristic_m(const CostGrid& grid, std::size_t from, std::size_t to) {
    const auto n = static_cast<std::size_t>(grid.columns);
    const double dx = std::abs(static_cast<double>(from % n) - static_cast<double>(to % n));
    const double dy = std::abs(static_cast<double>(from / n) - static_cast<double>(to / n));
    return grid.cell_m * (std::max(dx, dy) + (std::sqrt(2.0) - 1.0) * std::min(dx, dy));
  }

  Path collect(const CostGrid& grid, std::size_t from, std::size_t to) const {
    Path path;
    path.found = true;
    path.price_m = price_m_[to];
    for (std::size_t cell = to; cell != kNone; cell = cell == from ? kNone : parent_[cell])
      path.points.push_back(grid.centre(cell));
    std::reverse(path.points.begin(), path.points.end());
    for (std::size_t i = 1; i < path.points.size(); ++i)
      path.length_m += distance_m(path.points[i - 1], path.points[i]);
    return path;
  }

  PlanRules rules_;
  std::vector<double> weight_, price_m_;  ///< of a metre; from the start
  std::vector<std::size_t> parent_;
  std::vector<Node> open_;  ///< a heap
};

struct Posture {
  Point at;
  double heading_rad = 0.0;
};

/// What the vehicle is told: forward speed and curvature of the arc, positive to the left.
struct Drive {
  double speed_mps = 0.0, curvature_per_m = 0.0;
};

struct FollowRules {
  double speed_mps = 0.7;
  double look_ahead_m = 0.5;
  double max_curvature_per_m = 2.0;
  double goal_radius_m = 0.3;  ///< nearer than this to the path's end it has arrived and stops
};

/// Pure pursuit (Coulter 1992): the arc through the point of the path that lies look_ahead_m beyond the place nearest
/// to the vehicle. It slows down as the arc tightens, to a third; the tightest arc turns it where the path leads
/// backwards.
inline Drive follow(const Path& path, const Posture& posture, const FollowRules& rules) {
  if (path.points.empty() || distance_m(path.points.back(), posture.at) <= rules.goal_radius_m) return {};
  std::size_t target = 0;
  for (std::size_t i = 1; i < path.points.size(); ++i)
    if (distance_m(path.points[i], posture.at) < distance_m(path.points[target], posture.at)) target = i;
  double ahead_m = 0.0;
  while (target + 1 < path.points.size() && ahead_m < rules.look_ahead_m) {
    ahead_m += distance_m(path.points[target], path.points[target + 1]);
    ++target;
  }
  const double dx = path.points[target].x_m - posture.at.x_m, dy = path.points[target].y_m - posture.at.y_m;
  const double cosine = std::cos(posture.heading_rad), sine = std::sin(posture.heading_rad);
  const double forward_m = cosine * dx + sine * dy, left_m = cosine * dy - sine * dx;
  const double squared_m2 = std::max(forward_m * forward_m + left_m * left_m, 1e-6);
  double curvature = 2.0 * left_m / squared_m2;
  if (forward_m < 0.0) curvature = left_m < 0.0 ? -rules.max_curvature_per_m : rules.max_curvature_per_m;
  curvature = std::clamp(curvature, -rules.max_curvature_per_m, rules.max_curvature_per_m);
  const double tightness = std::abs(curvature) / rules.max_curvature_per_m;
  return {rules.speed_mps * (1.0 - 2.0 / 3.0 * tightness), curvature};
}

}  // namespace scree_example
