#include "fractal/vecchia_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree::fractal {
namespace {

constexpr double kPointsPerCell = 3.0;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// The nearest so far, sorted.
struct Nearest {
  std::array<double, kVecchiaNeighbours> distance2;
  Predecessors index{};

  Nearest() { distance2.fill(kFar); }
  double worst() const { return distance2.back(); }
  void offer(double d2, std::int32_t i) {
    if (!(d2 < worst())) return;
    int at = kVecchiaNeighbours - 1;
    for (; at > 0 && d2 < distance2[static_cast<std::size_t>(at - 1)]; --at) {
      distance2[static_cast<std::size_t>(at)] = distance2[static_cast<std::size_t>(at - 1)];
      index[static_cast<std::size_t>(at)] = index[static_cast<std::size_t>(at - 1)];
    }
    distance2[static_cast<std::size_t>(at)] = d2;
    index[static_cast<std::size_t>(at)] = i;
  }
};

/// Cells over the main box; those at its rim reach to infinity. Each cell has room for the points that will come
/// before the next rebuild.
class PointGrid {
 public:
  PointGrid(const Box& box, std::size_t total) : box_(box), total_(total) {}

  void rebuild(const std::vector<VecchiaPoint>& points, std::size_t inserted) {
    const std::size_t coming = std::min(2 * inserted, total_);
    const double width = box_.x_max - box_.x_min, height = box_.y_max - box_.y_min;
    const double most = std::sqrt(static_cast<double>(coming) / kPointsPerCell);
    side_ = std::max({std::sqrt(width * height / static_cast<double>(coming) * kPointsPerCell), width / (most * most),
                      height / (most * most), 1e-300});
    columns_ = std::max(1, static_cast<int>(std::ceil(width / side_)));
    rows_ = std::max(1, static_cast<int>(std::ceil(height / side_)));
    begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (std::size_t i = 0; i < coming; ++i) ++begin_[cell(points[i]) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    end_.assign(begin_.begin(), begin_.end() - 1);
    entries_.resize(coming);
    for (std::size_t i = 0; i < inserted; ++i) insert(points[i], i);
  }

  void insert(const VecchiaPoint& p, std::size_t i) {
    entries_[static_cast<std::size_t>(end_[cell(p)]++)] = {p.x, p.y, static_cast<std::int32_t>(i)};
  }

  Nearest nearest(const VecchiaPoint& p) const {
    Nearest found;
    const int column = column_of(p.x), row = row_of(p.y);
    for (int ring = 0;; ++ring) {
      const int left = column - ring, right = column + ring, bottom = row - ring, top = row + ring;
      for (int r = std::max(bottom, 0); r <= std::min(top, rows_ - 1); ++r) {
        if (r == bottom || r == top || ring == 0) {
          visit(p, r, std::max(left, 0), std::min(right, columns_ - 1), found);
        } else {
          if (left >= 0) visit(p, r, left, left, found);
          if (right < columns_) visit(p, r, right, right, found);
        }
      }
      const double reach = std::min(std::min(left > 0 ? p.x - (box_.x_min + left * side_) : kFar,
                                             right < columns_ - 1 ? box_.x_min + (right + 1) * side_ - p.x : kFar),
                                    std::min(bottom > 0 ? p.y - (box_.y_min + bottom * side_) : kFar,
                                             top < rows_ - 1 ? box_.y_min + (top + 1) * side_ - p.y : kFar));
      if (reach == kFar || (reach > 0.0 && found.worst() <= reach * reach)) return found;
    }
  }

 private:
  struct Entry {
    double x, y;
    std::int32_t index;
  };

  int column_of(double x) const {
    return static_cast<int>(std::clamp((x - box_.x_min) / side_, 0.0, static_cast<double>(columns_ - 1)));
  }
  int row_of(double y) const {
    return static_cast<int>(std::clamp((y - box_.y_min) / side_, 0.0, static_cast<double>(rows_ - 1)));
  }
  std::size_t cell(const VecchiaPoint& p) const {
    return static_cast<std::size_t>(row_of(p.y)) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column_of(p.x));
  }
  void visit(const VecchiaPoint& p, int row, int first, int last, Nearest& found) const {
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    for (auto c = base + static_cast<std::size_t>(first); c <= base + static_cast<std::size_t>(last); ++c)
      for (auto e = static_cast<std::size_t>(begin_[c]); e < static_cast<std::size_t>(end_[c]); ++e) {
        const double dx = entries_[e].x - p.x, dy = entries_[e].y - p.y;
        found.offer(dx * dx + dy * dy, entries_[e].index);
      }
  }

  Box box_;
  std::size_t total_;
  double side_ = 1.0;
  int rows_ = 1, columns_ = 1;
  std::vector<std::int32_t> begin_, end_;
  std::vector<Entry> entries_;
};

}  // namespace

std::vector<Predecessors> nearest_predecessors(const std::vector<VecchiaPoint>& points) {
  std::vector<Predecessors> out(points.size());
  PointGrid grid(main_box(points), points.size());
  std::size_t room = 1;  // points that the grid has cells for
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (i >= room) {
      grid.rebuild(points, i);
      room = 2 * i;
    }
    out[i] = grid.nearest(points[i]).index;
    grid.insert(points[i], i);
  }
  return out;
}

}  // namespace scree::fractal
