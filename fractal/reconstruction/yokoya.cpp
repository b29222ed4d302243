#include "fractal/reconstruction/yokoya.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/random.hpp"
#include "fractal/reconstruction/draw_spread.hpp"
#include "fractal/reconstruction/sample_lattice.hpp"
#include "fractal/reconstruction/surface_checks.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kNoiseStream = 0x796f6b6f79612d6e;  // "yokoya-n"

class Midpoints {
 public:
  Midpoints(const CellSamples& samples, const SampleLattice& lattice, const FractalLaw& law, double cell_m,
            std::uint64_t seed)
      : samples_(samples), lattice_(lattice), law_(law), cell_m_(cell_m), seed_(seed) {}

  /// Draw `k` into `z`; k < 0: without noise.
  void fill(int k, Grid<float>& z) const {
    z.assign(samples_.height_m.rows(), samples_.height_m.columns(), std::numeric_limits<float>::quiet_NaN());
    for (int i = 0; i < lattice_.rows; ++i)
      for (int j = 0; j < lattice_.columns; ++j) {
        const int r = lattice_.row + i * lattice_.step, c = lattice_.column + j * lattice_.step;
        z(r, c) = samples_.height_m(r, c);
      }
    for (int step = lattice_.step; step > 1; step /= 2) {
      fill_centres(step, k, z);
      fill_sides(step, k, z);
    }
  }

 private:
  void fill_centres(int step, int k, Grid<float>& z) const {
    const int half = step / 2;
    const double sd = displacement(half * std::numbers::sqrt2);
    for (int r = lattice_.row + half; r < lattice_.last_row(); r += step)
      for (int c = lattice_.column + half; c < lattice_.last_column(); c += step)
        place(r, c, {{{-half, -half}, {-half, half}, {half, -half}, {half, half}}}, sd, k, z);
  }
  void fill_sides(int step, int k, Grid<float>& z) const {
    const int half = step / 2;
    const double sd = displacement(half);
    for (int i = 0; lattice_.row + i * half <= lattice_.last_row(); ++i)
      for (int j = 1 - i % 2; lattice_.column + j * half <= lattice_.last_column(); j += 2)
        place(lattice_.row + i * half, lattice_.column + j * half, {{{-half, 0}, {half, 0}, {0, -half}, {0, half}}}, sd,
              k, z);
  }
  /// Mean of the neighbours within the lattice, and noise.
  void place(int r, int c, const std::array<std::pair<int, int>, 4>& neighbours, double sd, int k,
             Grid<float>& z) const {
    double sum = 0.0;
    int count = 0;
    for (const auto& [dr, dc] : neighbours)
      if (r + dr >= lattice_.row && r + dr <= lattice_.last_row() && c + dc >= lattice_.column &&
          c + dc <= lattice_.last_column())
        sum += static_cast<double>(z(r + dr, c + dc)), ++count;
    const double noise =
        k < 0 ? 0.0 : sd * random_normals(seed_, kNoiseStream + static_cast<std::uint64_t>(k), c, r)[0];
    z(r, c) = static_cast<float>(sum / count + noise);
  }
  /// √(1 − 2^(2H−2)): what the mean of two ends leaves of fBm at their middle, here for all neighbourhoods.
  double displacement(double distance_cells) const {
    return std::sqrt(1.0 - std::exp2(2.0 * law_.hurst() - 2.0)) * law_.rms_change_m(distance_cells * cell_m_);
  }

  const CellSamples& samples_;
  SampleLattice lattice_;
  FractalLaw law_;
  double cell_m_;
  std::uint64_t seed_;
};

}  // namespace

Result<SurfaceEstimate> reconstruct_yokoya(const CellSamples& samples, const SurfaceRequest& request,
                                           Executor& executor) {
  if (Status status = check_surface("yokoya", samples, request); !status) return status.error();
  if (Status status = check_one_law("yokoya", request.law); !status) return status.error();
  const auto lattice = find_lattice("yokoya", samples);
  if (!lattice) return lattice.error();
  const Midpoints midpoints(samples, *lattice, request.law.law, request.grid.cell_m, request.seed);
  SurfaceEstimate estimate;
  midpoints.fill(-1, estimate.mean_m);
  estimate.sd_m = spread_of_draws(
      request, estimate.mean_m, [&](int k, Grid<float>& draw_m) { midpoints.fill(k, draw_m); }, executor);
  estimate.iterations = std::countr_zero(static_cast<unsigned>(lattice->step));
  return estimate;
}

}  // namespace scree::fractal
