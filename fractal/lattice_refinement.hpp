#pragma once
// What the generators that refine a lattice have in common: the lattice, its noise, the checks and the scale.

#include <cstdint>
#include <functional>
#include <string_view>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// A (2^n + 1)² lattice; every half step has noise of its own, keyed on place.
class RefinedLattice {
 public:
  /// Corners from unit noise.
  RefinedLattice(int levels, std::uint64_t seed, std::uint64_t stream);

  int side() const { return heights_.rows(); }
  Grid<float>& heights() { return heights_; }
  /// Standard normal of cell (row, column) in the current half step.
  float noise(int row, int column) const;
  void next_half_step() { ++half_step_; }

  /// Cells (offset + i·spacing, …) of the lattice get the mean of the four (at the border three) cells at distance
  /// `reach` along the axes, plus sigma·noise. The cells are those whose row + column is odd in units of `reach`.
  void fill_edges(int reach, float sigma);
  /// Centres of squares of side 2·reach: the mean of the four corners plus sigma·noise.
  void fill_centres(int reach, float sigma);
  /// sigma·noise on every cell whose row and column are multiples of `spacing`, shifted by `offset`.
  void add_noise(int spacing, int offset, float sigma);

 private:
  Grid<float> heights_;
  std::uint64_t seed_, stream_;
  int half_step_ = 0;
};

/// Fills a lattice of 2^levels + 1 cells a side from the seed.
using Refinement = std::function<void(RefinedLattice& lattice)>;

/// Checks the arguments (errors name `model`), refines, cuts rows × columns and scales to the law's amplitude.
Result<Grid<float>> refined_surface(std::string_view model, const FractalLaw& law, int rows, int columns, double cell_m,
                                    std::uint64_t seed, std::uint64_t stream, const Refinement& refine);

}  // namespace scree::fractal
