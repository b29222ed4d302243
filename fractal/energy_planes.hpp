#pragma once
// What a map of D needs of the heights: energies and counts of the increments of every cell and their window sums, kept
// from one update to the next, so that a changed cell costs only the increments that contain it.

#include <array>
#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/bit_plane.hpp"
#include "fractal/box_sum.hpp"
#include "fractal/dimension_fit.hpp"
#include "fractal/increments.hpp"

namespace scree::fractal {

/// One grid shape: heights (not finite = unknown), their noise variances, returns a cell.
struct CellHeights {
  const Grid<float>& height_m;
  const Grid<float>& variance_m2;
  const Grid<std::uint16_t>& hits;
};

class EnergyPlanes {
 public:
  explicit EnergyPlanes(int radius_cells) : radius_(radius_cells) {}

  /// Everything unknown on a grid of this shape.
  void clear(int rows, int columns);
  /// Moves everything by whole cells: what was at (r + rows, c + columns) is at (r, c), what enters is unknown.
  /// At most once between two updates.
  void scroll(int rows, int columns);
  /// Takes over what differs from the last input, and sums windows again. Bit for bit what clear() and one update()
  /// would give: an increment is a function of its cells, and a window sum of what is in the window.
  void update(const CellHeights& cells, Executor& executor);

  int rows() const { return heights_.rows; }
  int columns() const { return heights_.columns; }
  Support support() const { return support_; }
  /// Cells whose windows have changed since the update before.
  const BitPlane& changed() const { return changed_windows_; }

  enum class Content { too_little, flat, rough };
  /// flat: increments of the shortest class, all without energy. log_unit: log of the mean energy of the first class.
  Content window(std::size_t cell, int min_effective_cells, EnergyWindow& out, float& log_unit) const;

 private:
  /// The contrast classes have a plane for each direction, the others one for all.
  static constexpr int kPlaneCount = kClassCount + kContrastClassCount;
  static constexpr int first_plane(int c) { return c < kContrastClassCount ? 2 * c : c + kContrastClassCount; }

  struct RowSummary {
    float largest_m = 0.0F;
    bool any_hits = false;
  };
  /// What an update cannot see in the cells that are left.
  struct Gone {
    bool all = false;         ///< every window counts as changed
    int down = 0, right = 0;  ///< how far the grid has moved
    /// Cells next to the border that others have left, and those that have entered at the one opposite.
    void mark(int reach, BitPlane& plane) const;
  };

  void find_changes(const CellHeights& cells);
  RowSummary take_row(const CellHeights& cells, int row);
  void sum_class(int c, BoxScratch& scratch);
  void set_shares(std::size_t cell, EnergyWindow& out) const;
  void sum_plane(int c, int direction, int plane, BoxScratch& scratch);

  int radius_;
  MaskedHeights heights_;
  std::array<BoxSum, kPlaneCount> energies_, counts_;  // sums: log mean energy, log contrast; count
  BoxSum known_, variance_, inverse_hits_;
  std::array<BoxScratch, kClassCount + 1> scratch_;  // by task
  float rounding_variance_m2_ = 0.0F;
  Support support_ = Support::centre_point;
  Gone gone_;
  BitPlane changed_heights_, changed_increments_, changed_quantities_, changed_windows_;
};

}  // namespace scree::fractal
