#pragma once
// How strong each octave band is in each cell of a law that varies.

#include <functional>
#include <vector>

#include "fractal/reconstruction/law_pyramid.hpp"
#include "fractal/reconstruction/octave_bands.hpp"
#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// A_l(x) = exp(log σ(x) + log gain_l(H(x))), log σ and H smoothed by a Gaussian of an eighth of the band's wavelength:
/// heights are defined up to a constant, so amplitudes belong to waves and a wave has no place sharper than that.
/// Smoothing the logarithm keeps the long waves of rough ground out of the smooth ground beside it.
class BandAmplitudes {
 public:
  /// `law` varies and lies at `window`. Cost: about 6 ns a cell for seven bands. No allocation when the shape stays.
  void set(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int bands);

  /// B_l on a torus, or so much of it as the window needs from the torus' point (0, 0); called from the longest band to
  /// band 0, one at a time.
  using Bands = std::function<const Grid<float>&(int band)>;
  /// u = Σ A_l·B_l over the window's rows and columns, the first of `u`; `shift` cells of the torus (multiples of the
  /// coarsest spacing) lie between its point (0, 0) and lattice cell (0, 0). Coarse bands are collapsed from the
  /// longest on, each interpolated to the next one's points. Cost: about 1 ns a cell, bands given. Const, safe from
  /// many threads with a scratch each.
  struct Scratch {
    Grid<float> coarse, finer;
    std::vector<float> line;
  };
  void make_field(const Bands& bands, CellIndex shift, Scratch& scratch, PaddedField& u) const;

 private:
  void set_band(int band);
  void add_products(int band, const Grid<float>& torus, CellIndex shift, Grid<float>& out) const;

  LatticeWindow window_;
  LawPyramid pyramid_;
  std::vector<Grid<float>> amplitude_;  ///< at the lattice points that are multiples of the band's spacing
  LawPyramid::Level smooth_;
  Grid<float> scratch_;
};

}  // namespace scree::fractal
