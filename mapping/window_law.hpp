#pragma once
// One fractal law for the whole window, from the per-cell estimates.

#include <cstdint>
#include <optional>
#include <vector>

#include "fractal/dimension_map.hpp"
#include "fractal/surface.hpp"

namespace scree::mapping {

/// Fewer valid measured cells than this say nothing about the window.
inline constexpr int kLawCells = 30;

/// Precision-weighted median of D and of log amplitude over the measured cells whose estimate carries no flag; cells
/// flagged as noise-limited or not fractal are used only when too few are clean, because their D is a bound and their
/// amplitude still an upper one. Nothing when fewer than kLawCells remain. Medians come from histograms (D to 1/1024,
/// amplitude to 1 %): one pass, one fixed order.
class WindowLaw {
 public:
  std::optional<fractal::FractalLaw> estimate(const fractal::DimensionMap& map, const Grid<std::uint8_t>& measured);

 private:
  std::optional<fractal::FractalLaw> from(const fractal::DimensionMap& map, const Grid<std::uint8_t>& measured,
                                          std::uint8_t refused_flags);
  std::vector<double> dimension_weights_, amplitude_weights_;
};

/// A step of the exponential filter that keeps the law from jumping between frames: D and log amplitude move a fifth
/// of the way. The reconstruction's warm start lives on this.
fractal::FractalLaw follow(const fractal::FractalLaw& law, const fractal::FractalLaw& seen);

}  // namespace scree::mapping
