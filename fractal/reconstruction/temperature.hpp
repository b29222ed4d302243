#pragma once
// The temperature of a fractal prior: the variance scale of what the prior adds to a surface.

#include <cstdint>
#include <optional>
#include <string_view>

#include "fractal/surface.hpp"

namespace scree::fractal {

struct Temperature {
  enum class Kind : std::uint8_t {
    closed_form,  ///< T0 = σ0²·S0(H)·k0^−(2+2H): no search, from the fractal's spectrum
    empirical,    ///< [AK96] Table 3, found by search at seven D
    formula,      ///< [AK96] eq. 13, T0 = k·σ0² with one k for every D
    fixed,        ///< value_m2; 0 = relaxation without noise
  };
  Kind kind = Kind::closed_form;
  double value_m2 = 0.0;
};

/// "closed-form", "empirical", "formula", or a finite number ≥ 0 in square metres. Anything else: nothing.
std::optional<Temperature> parse_temperature(std::string_view text);

/// Wavenumber, in rad per cell of every level, at which the prior of a level is fractal.
inline constexpr double kSzeliskiWavenumber = 2.0;

/// Temperature of the finest level over σ0², σ0 the rms change over one cell of `cell_m`; for the energy
/// ½Σ[(D−2)·k0⁻²·|∇u|² + (3−D)·k0⁻⁴·(Δu)²] in cells, k0 = kSzeliskiWavenumber.
/// The paper's figures hold for an energy that it does not normalise and heights over a unit square of 256 × 256 cells,
/// σ0² = 2^(−16H); both of its laws are therefore multiplied by one number each, such that they are right at D = 2.4,
/// the D at which the paper fixes its own k. Table 3 is interpolated in D, and kept flat beyond 2.2 … 2.8, in the
/// logarithm of T/σ0². 2 < D < 3.
/// Sources: [AK96] eqs. 7, 13, Tables 3, 4; [Sz89]; docs/reconstruction.md.
double relative_temperature(const Temperature& temperature, const FractalLaw& law, double cell_m);

}  // namespace scree::fractal
