#include "fractal/midpoint_displacement.hpp"

#include <cmath>
#include <numbers>

#include "fractal/lattice_refinement.hpp"

namespace scree::fractal {
namespace {

/// Midpoints of the edges between (r, c) and (r + 2·row_step, c + 2·column_step), for one family of edges.
void split_edges(RefinedLattice& lattice, int reach, int row_step, int column_step, float sigma) {
  Grid<float>& z = lattice.heights();
  for (int r = 0; r + 2 * row_step < lattice.side(); r += 2 * reach)
    for (int c = 0; c + 2 * column_step < lattice.side(); c += 2 * reach) {
      const int row = r + row_step, column = c + column_step;
      z(row, column) = 0.5F * (z(r, c) + z(r + 2 * row_step, c + 2 * column_step)) + sigma * lattice.noise(row, column);
    }
}

}  // namespace

Result<Grid<float>> midpoint_displacement_squares(const FractalLaw& law, int rows, int columns, double cell_m,
                                                  std::uint64_t seed) {
  constexpr std::uint64_t kStream = 0x6d70642d73710000;  // "mpd-sq", half step
  const float half_step = static_cast<float>(std::pow(0.5, 0.5 * law.hurst()));
  const auto refine = [&](RefinedLattice& lattice) {
    float sigma = 1.0F;
    for (int reach = (lattice.side() - 1) / 2; reach >= 1; reach /= 2) {
      lattice.fill_centres(reach, sigma *= half_step);
      lattice.next_half_step();
      lattice.fill_edges(reach, sigma *= half_step);
      lattice.next_half_step();
    }
  };
  return refined_surface("square midpoint", law, rows, columns, cell_m, seed, kStream, refine);
}

Result<Grid<float>> midpoint_displacement_triangles(const FractalLaw& law, int rows, int columns, double cell_m,
                                                    std::uint64_t seed) {
  constexpr std::uint64_t kStream = 0x6d70642d74720000;  // "mpd-tr", half step
  const float step = static_cast<float>(std::pow(0.5, law.hurst()));
  const float diagonal = static_cast<float>(std::pow(std::numbers::sqrt2, law.hurst()));
  const auto refine = [&](RefinedLattice& lattice) {
    float sigma = 1.0F;
    for (int reach = (lattice.side() - 1) / 2; reach >= 1; reach /= 2) {
      sigma *= step;
      split_edges(lattice, reach, 0, reach, sigma);
      split_edges(lattice, reach, reach, 0, sigma);
      split_edges(lattice, reach, reach, reach, sigma * diagonal);
      lattice.next_half_step();
    }
  };
  return refined_surface("triangle midpoint", law, rows, columns, cell_m, seed, kStream, refine);
}

}  // namespace scree::fractal
