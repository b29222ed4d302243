#pragma once
// Fields with the law of the ground and nothing measured: what residuals are made from.

#include <cstdint>
#include <memory>

#include "core/grid.hpp"
#include "fractal/reconstruction/padded_field.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// The stream of field k: the last byte of `base` counts 256 of them, the top byte the rest, so that no two bases meet.
inline std::uint64_t field_stream(std::uint64_t base, int k) {
  const auto field = static_cast<std::uint64_t>(k);
  return base + (field & 0xff) + ((field >> 8) << 56);
}

/// Independent fields k = 0, 1, … over one window, in units of the rms change over one cell of the law (its middle).
/// Reproducible from the seed alone. make() may run for several k side by side.
class ResidualFields {
 public:
  virtual ~ResidualFields() = default;
  /// Fills the cells of the window, the first of `u`, which may be larger.
  virtual void make(int k, PaddedField& u) const = 0;
};

/// Side of the torus of a rows × columns window: the exact embedding where it is at most kExactSide; else somewhat
/// larger than the window and 16 gaps: what residuals keep of u is what the data around do not fix, waves of a few
/// gaps.
int residual_torus_side(double hurst, int rows, int columns, int gap_cells);
inline constexpr int kExactSide = 2048;

/// fBm of one law, exact up to half the side (a quarter for H > 0.75).
std::unique_ptr<ResidualFields> one_law_fields(double hurst, int side, const SurfaceGrid& grid, std::uint64_t seed);

/// Of a law that varies, by octave bands (octave_bands.hpp), the longest about four gaps and all beyond.
std::unique_ptr<ResidualFields> varying_fields(const LawMap& law, int side, int gap_cells, const SurfaceGrid& grid,
                                               std::uint64_t seed);

}  // namespace scree::fractal
