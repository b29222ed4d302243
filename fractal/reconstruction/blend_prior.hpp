#pragma once
// The 13-point membrane/thin-plate blend that looks like a fractal of dimension D around one wavenumber.

namespace scree::fractal {

/// Precision of the prior u'(w1·L + w2·L²)u, L the 5-point graph Laplacian, u in units of the rms change over one cell.
struct BlendWeights {
  float w1 = 0.5F;
  float w2 = 0.5F;
};

/// Closed form: the blend's spectrum 1/(w1·k² + w2·k⁴) has at k0 the value and the slope of the fractal's
/// S0(H)·k^−(2+2H), S0 = 2πH·4^H·Γ(1+H)/Γ(1−H):  w1 = (D−2)·k0^(2H)/S0, w2 = (3−D)·k0^(2H−2)/S0.
/// Source: [Sz89] as used by [AK96] eqs. 6–8; the sum of their weight functions fixed by the amplitude.
/// 2 < D < 3, k0 in rad per cell.
BlendWeights blend_weights(double dimension, double k0);

/// The wavenumber at which a blend of dimension D predicts best from data `spacing_cells` apart. The choice is flat:
/// 30 % either way costs less than half a percent of RMSE (docs/reconstruction.md).
double blend_wavenumber(double dimension, double spacing_cells);

}  // namespace scree::fractal
