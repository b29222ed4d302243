#include "fractal/reconstruction/temperature.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

namespace scree::fractal {
namespace {

constexpr double kPaperLevels = 8.0;  // 256 cells
constexpr double kFirst = 2.2, kStep = 0.1;
constexpr std::array<double, 7> kTable3 = {9.5e-6, 3.0e-5, 8.9e-5, 3.0e-4, 7.5e-4, 3.0e-3, 9.5e-3};
constexpr double kFormula = 4.7e-2;
// Our energy over the paper's, from the search for the right temperature at D = 2.4 (bench section paper-tables).
constexpr double kTable3Energy = 4.1, kFormulaEnergy = 6.0;

/// Table 3 over the σ0² of its surfaces.
double table3(double dimension) {
  const double position = std::clamp((dimension - kFirst) / kStep, 0.0, static_cast<double>(kTable3.size() - 1));
  const auto node = std::min(static_cast<std::size_t>(position), kTable3.size() - 2);
  const auto relative = [](std::size_t i) {
    const double hurst = 3.0 - (kFirst + kStep * static_cast<double>(i));
    return kTable3[i] * std::exp2(2.0 * kPaperLevels * hurst);
  };
  const double weight = position - static_cast<double>(node);
  return std::pow(relative(node), 1.0 - weight) * std::pow(relative(node + 1), weight);
}

double closed_form(double hurst) {
  const double s0 =
      2.0 * std::numbers::pi * hurst * std::pow(4.0, hurst) * std::tgamma(1.0 + hurst) / std::tgamma(1.0 - hurst);
  return s0 * std::pow(kSzeliskiWavenumber, -2.0 - 2.0 * hurst);
}

}  // namespace

std::optional<Temperature> parse_temperature(std::string_view text) {
  if (text == "closed-form") return Temperature{Temperature::Kind::closed_form, 0.0};
  if (text == "empirical") return Temperature{Temperature::Kind::empirical, 0.0};
  if (text == "formula") return Temperature{Temperature::Kind::formula, 0.0};
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value < 0.0)
    return std::nullopt;
  return Temperature{Temperature::Kind::fixed, value};
}

double relative_temperature(const Temperature& temperature, const FractalLaw& law, double cell_m) {
  switch (temperature.kind) {
    case Temperature::Kind::closed_form:
      return closed_form(law.hurst());
    case Temperature::Kind::empirical:
      return kTable3Energy * table3(law.dimension);
    case Temperature::Kind::formula:
      return kFormulaEnergy * kFormula;
    case Temperature::Kind::fixed:
      break;
  }
  const double sigma0 = law.rms_change_m(cell_m);
  return temperature.value_m2 / (sigma0 * sigma0);
}

}  // namespace scree::fractal
