#pragma once
// How strong each octave band is in each cell of a law that varies.

#include <vector>

#include "fractal/reconstruction/law_pyramid.hpp"
#include "fractal/reconstruction/octave_bands.hpp"

namespace scree::fractal {

/// A_l(x) = exp(log σ(x) + log gain_l(H(x))), log σ and H smoothed by a Gaussian of an eighth of the band's wavelength:
/// heights are defined up to a constant, so amplitudes belong to waves and a wave has no place sharper than that.
/// Smoothing the logarithm keeps the long waves of rough ground out of the smooth ground beside it.
class BandAmplitudes {
 public:
  /// `law` varies and lies at `window`. Cost: about 10 ns a cell for seven bands. No allocation when the shape stays.
  void set(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int bands);

  /// out += A_l·B_l for `count` cells of the lattice row `cell.y` from `cell.x` on, which lies in the window; `band`
  /// holds B_l on a torus, `shift` cells of which belong to lattice cell (0, 0). `line` is scratch.
  void add_row(int band, const Grid<float>& torus, CellIndex shift, CellIndex cell, int count, std::vector<float>& line,
               float* out) const;

 private:
  void set_band(int band);
  const float* row(int band, int i) const { return amplitude_[static_cast<std::size_t>(band)].row(i).data(); }

  LawPyramid pyramid_;
  std::vector<Grid<float>> amplitude_;  ///< at the lattice points that are multiples of the band's spacing
  LawPyramid::Level smooth_;
  Grid<float> scratch_;
};

}  // namespace scree::fractal
