#pragma once
// The eight classes of second-difference increments. Each annihilates every plane exactly.

#include <array>
#include <span>
#include <vector>

#include "core/grid.hpp"

namespace scree::fractal {

inline constexpr int kClassCount = 8;

struct IncrementPoint {
  int dx, dy;  ///< from the centre cell
  int weight;
};
using Increment = std::vector<IncrementPoint>;

enum class IncrementShape { axis, diagonal, square };

/// (1, −2, 1) along an axis or a diagonal, or (1, −1, −1, 1) on a square, of step h cells. A class holds the increments
/// that a symmetry of the lattice maps onto each other: two directions for the three-point shapes, one square.
struct IncrementClass {
  IncrementShape shape;
  int step;
  int multiplicity() const { return shape == IncrementShape::square ? 1 : 2; }
  /// Σ λ²: the variance that white noise of unit variance gives.
  int noise_gain() const { return shape == IncrementShape::square ? 4 : 6; }
  std::vector<Increment> increments() const;
};

inline constexpr std::array<IncrementClass, kClassCount> kClasses = {{{IncrementShape::axis, 1},
                                                                      {IncrementShape::diagonal, 1},
                                                                      {IncrementShape::axis, 2},
                                                                      {IncrementShape::diagonal, 2},
                                                                      {IncrementShape::axis, 4},
                                                                      {IncrementShape::square, 1},
                                                                      {IncrementShape::square, 2},
                                                                      {IncrementShape::square, 4}}};
/// The first classes are those whose two directions are compared with each other: axes and diagonals of steps 1 and 2.
inline constexpr int kContrastClassCount = 4;
inline constexpr int kIncrementReach = 4;  ///< cells beyond the centre

/// Heights with a rim of kIncrementReach unknown cells all round: height 0 and mask 0 where unknown, mask 1 elsewhere.
struct MaskedHeights {
  int rows = 0, columns = 0;  ///< without the rim
  std::vector<float> height, mask;
  /// Sets the shape; everything is unknown.
  void clear(int grid_rows, int grid_columns);
  int stride() const { return columns + 2 * kIncrementReach; }
  std::ptrdiff_t offset(int row, int column) const {
    return static_cast<std::ptrdiff_t>(row + kIncrementReach) * stride() + column + kIncrementReach;
  }
};

/// Sets `out`, keeping its buffers where they suffice. NaN and infinite heights are unknown.
void load_heights(const Grid<float>& height_m, MaskedHeights& out);

/// Variance of the rounding of float heights none of which exceeds `largest_m`: a twelfth of the square of one unit in
/// the last place of its binade.
double rounding_variance_m2(float largest_m);

inline constexpr int kAllDirections = -1;

/// Squares and counts of the complete increments of one class, centred at the cells [begin, end) of one row; `energy`
/// and `count` are whole rows. direction: index into increments(), or kAllDirections for their sum. Branch-free.
void increment_energies(const MaskedHeights& z, IncrementClass increment_class, int direction, int row, int begin,
                        int end, std::span<float> energy, std::span<float> count);

}  // namespace scree::fractal
