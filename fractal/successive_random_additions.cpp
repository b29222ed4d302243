#include "fractal/successive_random_additions.hpp"

#include <cmath>

#include "fractal/lattice_refinement.hpp"

namespace scree::fractal {

Result<Grid<float>> successive_random_additions(const FractalLaw& law, int rows, int columns, double cell_m,
                                                std::uint64_t seed) {
  constexpr std::uint64_t kStream = 0x7372612d00000000;  // "sra-", half step
  const float half_step = static_cast<float>(std::pow(0.5, 0.5 * law.hurst()));
  const auto refine = [&](RefinedLattice& lattice) {
    float sigma = 1.0F;
    for (int reach = (lattice.side() - 1) / 2; reach >= 1; reach /= 2) {
      sigma *= half_step;  // the lattice with centres is finer by √2
      lattice.fill_centres(reach, sigma);
      lattice.add_noise(2 * reach, 0, sigma);
      lattice.next_half_step();
      sigma *= half_step;
      lattice.fill_edges(reach, sigma);
      lattice.add_noise(2 * reach, 0, sigma);
      lattice.add_noise(2 * reach, reach, sigma);
      lattice.next_half_step();
    }
  };
  return refined_surface("SRA", law, rows, columns, cell_m, seed, kStream, refine);
}

}  // namespace scree::fractal
