#include "mapping/window_law.hpp"

#include <algorithm>
#include <cmath>

namespace scree::mapping {

namespace {

constexpr int kBins = 1024;
constexpr double kAmplitudeMin_m = 1e-4;
constexpr double kAmplitudeMax_m = 10.0;
constexpr double kFollow = 0.2;
// No estimate of D from a window of cells is better than this, whatever its interval says.
constexpr double kDimensionSigmaMin = 0.02;
// An exact plane has amplitude 0 and no interval: it counts as the smoothest ground there is, with little weight.
constexpr double kDimensionSigmaUnknown = 0.3;

double amplitude_span() {
  return std::log(kAmplitudeMax_m / kAmplitudeMin_m);
}

std::size_t bin_of(double share) {
  return static_cast<std::size_t>(std::clamp(share * kBins, 0.0, kBins - 1.0));
}

// Where half of the weight is reached, 0 … 1 over the histogram, linear inside the bin.
double median_share(const std::vector<double>& weights) {
  double total = 0.0;
  for (const double w : weights) total += w;
  double below = 0.0;
  for (std::size_t bin = 0; bin < weights.size(); ++bin) {
    if (below + weights[bin] >= 0.5 * total)
      return (static_cast<double>(bin) + (0.5 * total - below) / weights[bin]) / kBins;
    below += weights[bin];
  }
  return 1.0;
}

}  // namespace

std::optional<fractal::FractalLaw> WindowLaw::from(const fractal::DimensionMap& map, const Grid<std::uint8_t>& measured,
                                                   std::uint8_t refused_flags) {
  dimension_weights_.assign(kBins, 0.0);
  amplitude_weights_.assign(kBins, 0.0);
  int cells = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (measured[i] == 0 || (map.flags[i] & refused_flags) != 0) continue;
    const auto dimension = static_cast<double>(map.dimension[i]);
    const auto amplitude_m = std::max(static_cast<double>(map.amplitude_m[i]), kAmplitudeMin_m);
    const auto given_sigma = static_cast<double>(map.dimension_sigma[i]);
    const double sigma = std::isfinite(given_sigma) ? given_sigma : kDimensionSigmaUnknown;
    if (!std::isfinite(dimension + amplitude_m)) continue;
    const double weight = 1.0 / (sigma * sigma + kDimensionSigmaMin * kDimensionSigmaMin);
    dimension_weights_[bin_of(dimension - 2.0)] += weight;
    amplitude_weights_[bin_of(std::log(amplitude_m / kAmplitudeMin_m) / amplitude_span())] += weight;
    ++cells;
  }
  if (cells < kLawCells) return std::nullopt;
  fractal::FractalLaw law;
  law.dimension = std::clamp(2.0 + median_share(dimension_weights_), 2.05, 2.95);
  law.amplitude_m = kAmplitudeMin_m * std::exp(median_share(amplitude_weights_) * amplitude_span());
  return law;
}

std::optional<fractal::FractalLaw> WindowLaw::estimate(const fractal::DimensionMap& map,
                                                       const Grid<std::uint8_t>& measured) {
  const auto clean =
      from(map, measured, fractal::kTooLittleData | fractal::kNoiseLimited | fractal::kNotFractal | fractal::kAtBound);
  return clean ? clean : from(map, measured, fractal::kTooLittleData);
}

fractal::FractalLaw follow(const fractal::FractalLaw& law, const fractal::FractalLaw& seen) {
  fractal::FractalLaw next = law;
  next.dimension += kFollow * (seen.dimension - law.dimension);
  next.amplitude_m *= std::exp(kFollow * std::log(seen.amplitude_m / law.amplitude_m));
  return next;
}

}  // namespace scree::mapping
