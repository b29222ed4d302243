#include "fractal/lattice_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr int kMaxSide = (1 << 14) + 1;

Status check(std::string_view model, const FractalLaw& law, int rows, int columns, double cell_m) {
  const auto usage = [&](const std::string& message) {
    return Error{ErrorKind::usage, fmt::format("{} surface: {}", model, message)};
  };
  if (!(law.dimension > 2.0 && law.dimension < 3.0))
    return usage(fmt::format("expected 2 < D < 3, found D = {}", law.dimension));
  if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
    return usage(fmt::format("expected a finite amplitude_m > 0, found {}", law.amplitude_m));
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return usage(fmt::format("expected a finite cell_m > 0, found {}", cell_m));
  if (std::min(rows, columns) < 2 || std::max(rows, columns) > kMaxSide)
    return usage(fmt::format("expected 2 to {} cells a side, found {} x {} cells", kMaxSide, rows, columns));
  return {};
}

/// Mean squared change over `lag` cells along both axes.
double mean_square_change(const Grid<float>& z, int lag) {
  double sum = 0.0, pairs = 0.0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      if (c + lag < z.columns()) sum += std::pow(double{z(r, c + lag)} - z(r, c), 2), pairs += 1.0;
      if (r + lag < z.rows()) sum += std::pow(double{z(r + lag, c)} - z(r, c), 2), pairs += 1.0;
    }
  return sum / pairs;
}

/// rms change over 1 m: along a straight line in the log–log plot between whole cells, with slope H outside of
/// [1 cell, half the surface].
double rms_change_at_1_m(const Grid<float>& z, const FractalLaw& law, double cell_m) {
  const double lag = 1.0 / cell_m;
  const int last = std::max(1, std::min(z.rows(), z.columns()) / 2);
  const int below = static_cast<int>(std::clamp(std::floor(lag + 1e-9), 1.0, static_cast<double>(last)));
  const double rms = std::sqrt(mean_square_change(z, below));
  double slope = law.hurst();
  if (lag > below && below + 1 <= last)
    slope = std::log(std::sqrt(mean_square_change(z, below + 1)) / rms) / std::log((below + 1.0) / below);
  return rms * std::pow(lag / below, slope);
}

}  // namespace

RefinedLattice::RefinedLattice(int levels, std::uint64_t seed, std::uint64_t stream)
    : heights_((1 << levels) + 1, (1 << levels) + 1), seed_(seed), stream_(stream) {
  add_noise(1 << levels, 0, 1.0F);
  next_half_step();
}

float RefinedLattice::noise(int row, int column) const {
  return static_cast<float>(random_normals(seed_, stream_ + static_cast<std::uint64_t>(half_step_), column, row)[0]);
}

void RefinedLattice::fill_centres(int reach, float sigma) {
  for (int r = reach; r < side(); r += 2 * reach)
    for (int c = reach; c < side(); c += 2 * reach)
      heights_(r, c) = 0.25F * (heights_(r - reach, c - reach) + heights_(r - reach, c + reach) +
                                heights_(r + reach, c - reach) + heights_(r + reach, c + reach)) +
                       sigma * noise(r, c);
}

void RefinedLattice::fill_edges(int reach, float sigma) {
  for (int r = 0; r < side(); r += reach)
    for (int c = (r / reach % 2 == 0 ? reach : 0); c < side(); c += 2 * reach) {
      float sum = 0.0F;
      int known = 0;
      const auto take = [&](int row, int column) {
        if (heights_.contains(row, column)) sum += heights_(row, column), ++known;
      };
      take(r - reach, c), take(r + reach, c), take(r, c - reach), take(r, c + reach);
      heights_(r, c) = sum / static_cast<float>(known) + sigma * noise(r, c);
    }
}

void RefinedLattice::add_noise(int spacing, int offset, float sigma) {
  for (int r = offset; r < side(); r += spacing)
    for (int c = offset; c < side(); c += spacing) heights_(r, c) += sigma * noise(r, c);
}

Result<Grid<float>> refined_surface(std::string_view model, const FractalLaw& law, int rows, int columns, double cell_m,
                                    std::uint64_t seed, std::uint64_t stream, const Refinement& refine) {
  if (Status status = check(model, law, rows, columns, cell_m); !status) return status.error();
  int levels = 0;
  while ((1 << levels) + 1 < std::max(rows, columns)) ++levels;
  RefinedLattice lattice(levels, seed, stream);
  refine(lattice);
  Grid<float> surface(rows, columns);
  for (int r = 0; r < rows; ++r) std::copy_n(lattice.heights().row(r).begin(), columns, surface.row(r).begin());
  const double origin = surface(0, 0), scale = law.amplitude_m / rms_change_at_1_m(surface, law, cell_m);
  for (float& z : surface) z = static_cast<float>(scale * (z - origin));
  return surface;
}

}  // namespace scree::fractal
