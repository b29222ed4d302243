// What the outcome of analyse_scales is called, and whether it is any good.

#include <array>
#include <cmath>

#include "fractal/scale_laws.hpp"

namespace scree::fractal {

std::string_view scale_law_name(ScaleLaw law) {
  constexpr std::array<std::string_view, 4> kNames{"power", "power_and_noise", "two_scales", "plateau"};
  return kNames[static_cast<std::size_t>(law)];
}

bool ScaleAnalysis::law_fits() const {
  constexpr double kNormal999 = 3.090232;  // Wilson and Hilferty: the cube root of chi-square is nearly normal
  const double n = best().degrees_of_freedom, part = 2.0 / (9.0 * n);
  return best().chi_square <= n * std::pow(1.0 - part + kNormal999 * std::sqrt(part), 3.0);
}

}  // namespace scree::fractal
