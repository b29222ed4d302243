#pragma once
// The points of one frame, gathered by map cell.

#include <cstdint>
#include <span>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "drivers/frame/point_frame.hpp"

namespace scree::mapping {

/// Counting sort of a frame's points by window cell; within a cell the order is the frame's, so every sum over a cell
/// has one order for any executor. Buffers are kept between frames.
class CellPoints {
 public:
  /// Points outside `window` (or not finite) are counted, not kept. Cost: O(points + cells).
  void sort(const PointFrame& frame, const LatticeWindow& window, double cell_m, Executor& executor);

  int rows() const { return window_.rows; }
  int columns() const { return window_.columns; }
  std::uint64_t outside() const { return outside_; }
  int count(int row, int column) const {
    const auto cell = index(row, column);
    return static_cast<int>(begin_[cell + 1] - begin_[cell]);
  }
  /// Heights relative to the frame's anchor; the caller may reorder them.
  std::span<float> heights_m(int row, int column) { return piece(z_m_, row, column); }
  /// Of the places, see place_variance: along z, and along one horizontal axis.
  std::span<float> variances_m2(int row, int column) { return piece(variance_m2_, row, column); }
  std::span<float> horizontal_variances_m2(int row, int column) { return piece(horizontal_m2_, row, column); }

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(window_.columns) + static_cast<std::size_t>(column);
  }
  std::span<float> piece(std::vector<float>& values, int row, int column) {
    const auto cell = index(row, column);
    return std::span(values).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
  }

  LatticeWindow window_;
  std::uint64_t outside_ = 0;
  std::vector<std::int32_t> cell_of_;  ///< per point; -1 = outside
  std::vector<std::uint32_t> begin_;   ///< cells + 1 offsets
  std::vector<std::uint32_t> next_;
  std::vector<float> z_m_, variance_m2_, horizontal_m2_;
};

}  // namespace scree::mapping
