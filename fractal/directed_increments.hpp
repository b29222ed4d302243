#pragma once
// Second differences along single directions: their energies, which of them are complete, and how often two of them
// stand at a given offset.

#include <array>
#include <vector>

#include "fractal/bit_plane.hpp"
#include "fractal/increments.hpp"

namespace scree::fractal {

/// (1, −2, 1) with the outer cells at ±(dx, dy). Two neighbours in the list are a contrast: mirror images of each other
/// under a symmetry of the lattice, with the same expected energy on isotropic ground.
struct DirectedStep {
  int dx, dy;
  Increment increment() const { return {{-dx, -dy, 1}, {0, 0, -2}, {dx, dy, 1}}; }
};
inline constexpr int kDirectedCount = 8;
inline constexpr int kContrastCount = 4;
inline constexpr std::array<DirectedStep, kDirectedCount> kDirectedSteps = {
    {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}, {0, 2}, {2, 2}, {2, -2}}};

struct DirectedEnergies {
  std::array<double, kDirectedCount> mean_square_m2{}, count{};
  std::array<BitPlane, kDirectedCount> complete;  ///< by centre cell
};
DirectedEnergies directed_energies(const MaskedHeights& heights);

/// Number of pairs of complete increments, `first` at a cell and `second` at that cell + (ox, oy), |ox|, |oy| ≤
/// `reach`: element (oy + reach)·(2·reach + 1) + ox + reach. Of planes with more than 2^20 cells every n-th row is
/// counted, and the result scaled. Cost: (2·reach + 1)²·cells/64 word operations.
std::vector<double> pair_counts(const BitPlane& first, const BitPlane& second, int reach);

}  // namespace scree::fractal
