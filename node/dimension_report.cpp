#include "node/dimension_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

#include "node/dimension_scales.hpp"
#include "node/length_text.hpp"

namespace scree::node {
namespace {

using fractal::DimensionEstimate;
using fractal::ScaleLaw;

bool has_flag(const DimensionAnswer& answer, const char* flag) {
  return std::find(answer.flags.begin(), answer.flags.end(), flag) != answer.flags.end();
}

std::string interval_text(const DimensionAnswer& answer) {
  const DimensionEstimate& estimate = answer.estimate;
  if (!answer.has_interval) return "no interval";
  const bool below = estimate.flags & fractal::kOpenBelow, above = estimate.flags & fractal::kOpenAbove;
  if (below && above) return "95 %: anything from 2 to 3";
  if (below) return fmt::format("95 %: at most {:.3f}", estimate.interval95.high);
  if (above) return fmt::format("95 %: at least {:.3f}", estimate.interval95.low);
  return fmt::format("95 %: {:.3f} to {:.3f}", estimate.interval95.low, estimate.interval95.high);
}

std::string noise_text(const DimensionReport& report) {
  const DimensionRequest& request = report.request;
  if (report.answer.raw_heights) {
    const bool given = request.noise_sigma_m > 0.0 || request.noise_xy_sigma_m > 0.0;
    return std::string("noise and tilt not taken off") + (given ? " (this method cannot use the noise given)" : "");
  }
  std::string text = fmt::format("noise {:g} m", request.noise_sigma_m);
  if (request.noise_auto)
    text = "noise " + length_text(report.answer.estimate.noise_sigma_m) + " m estimated";
  else if (request.noise_sigma_m == 0.0 && request.noise_xy_sigma_m == 0.0)
    text += " assumed (--noise-sigma-m)";
  if (request.noise_xy_sigma_m > 0.0)
    text += fmt::format(" and {:g} m horizontal: {} m in all", request.noise_xy_sigma_m,
                        length_text(report.answer.noise_sigma_m));
  return text;
}

std::string scales_remark(const fractal::ScaleAnalysis& scales) {
  const fractal::ScaleLawFit& best = scales.best();
  std::string fine = fmt::format("D = {:.3f}", best.dimension);
  if (scales.law_fits()) fine += fmt::format(" ({:.3f} to {:.3f})", best.interval95.low, best.interval95.high);
  if (best.law == ScaleLaw::two_scales)
    return fmt::format("crossover: two power laws, {} below and D = {:.3f} above {}", fine, best.coarse_dimension,
                       crossover_text(best));
  if (best.law == ScaleLaw::plateau)
    return fmt::format("plateau: {} for short distances, and no growth far beyond {}", fine, crossover_text(best));
  return fmt::format("excess_noise: heights vary by {} m more than the noise given says; {} above that",
                     length_text(best.noise_sigma_m), fine);
}

void add_scales(const DimensionAnswer& answer, std::vector<std::string>& remarks) {
  if (!answer.scales || !std::isfinite(answer.estimate.dimension)) return;
  const auto& best = answer.scales->best();
  if (!answer.scales->law_fits())
    remarks.push_back(fmt::format("no_law_fits: chi-square {:.0f} with {} degrees of freedom for the best of four laws",
                                  best.chi_square, best.degrees_of_freedom));
  if (best.law != ScaleLaw::power && !says_nothing(best)) remarks.push_back(scales_remark(*answer.scales));
}

/// The probability is that of one power law, which the ground may not have.
std::string anisotropy_text(const fractal::Anisotropy& found, const DimensionAnswer& answer) {
  const bool other = has_flag(answer, "scale_dependent") || has_flag(answer, "no_law_fits");
  const std::string chance = fmt::format("(p = {:.2g}{})", found.p_value, other ? " under one power law" : "");
  if (!found.significant) return "isotropic " + chance;
  if (!found.matters()) return fmt::format("nearly isotropic, stretched {:.2f} times {}", found.strength, chance);
  return fmt::format("roughest along {:.0f} deg from +x, stretched {:.2f} times across {}",
                     found.direction_rad * 180.0 / std::numbers::pi, found.strength, chance);
}

}  // namespace

std::vector<std::string> all_flags(const DimensionReport& report) {
  std::vector<std::string> flags = report.answer.flags;
  if (report.anisotropy && report.anisotropy->matters()) flags.emplace_back("anisotropic");
  return flags;
}

std::string dimension_line(const DimensionReport& report) {
  const DimensionAnswer& answer = report.answer;
  const DimensionEstimate& estimate = answer.estimate;
  std::string line =
      std::isfinite(estimate.dimension)
          ? fmt::format("D = {:.3f} ({}), amplitude {:.4g} m at 1 m", estimate.dimension, interval_text(answer),
                        estimate.amplitude_m)
          : fmt::format("D unknown ({}): {}", interval_text(answer),
                        answer.raw_heights ? "the fitted line has a D outside 2 ... 3" : "the noise hides the ground");
  line += fmt::format("; {}, {} {}", estimate.method, estimate.points, report.input.cells() ? "cells" : "points");
  if (sampled(report.input, answer)) line += fmt::format(" of {}", report.input.found);
  const auto& scales = answer.scale_range_m;
  line += std::isfinite(scales.low) ? ", " + range_text(scales.low, scales.high) : ", no scale above the noise";
  if (has_flag(answer, "scale_range_short")) line += " (all that D rests on)";
  line += ", " + noise_text(report);
  if (report.anisotropy) line += "; " + anisotropy_text(*report.anisotropy, answer);
  const auto flags = all_flags(report);
  if (!flags.empty()) line += fmt::format("; flags: {}", fmt::join(flags, ", "));
  return line + "\n";
}

std::vector<std::string> dimension_remarks(const DimensionReport& report) {
  const DimensionAnswer& answer = report.answer;
  const DimensionEstimate& estimate = answer.estimate;
  std::vector<std::string> remarks;
  if (estimate.flags & fractal::kScaleDependent)
    remarks.push_back(fmt::format("scale_dependent: D = {:.3f} at {} m spacing, {:.3f} at {} m", estimate.dimension,
                                  length_text(estimate.spacing_m), estimate.coarse_dimension,
                                  length_text(estimate.coarse_spacing_m)));
  if (answer.check && answer.agreement.comparable && !answer.agreement.agree)
    remarks.push_back(fmt::format("methods_disagree: the {} has D = {:.3f} ({:.3f} to {:.3f})", answer.check->method,
                                  answer.check->dimension, answer.check->interval95.low,
                                  answer.check->interval95.high));
  if (answer.noise_check && (answer.noise_check->too_large || answer.noise_check->too_small)) {
    const DimensionEstimate& free = answer.noise_check->free;
    remarks.push_back(fmt::format("{}: the heights show {} m, and then D = {:.3f} ({:.3f} to {:.3f})",
                                  answer.noise_check->too_large ? "noise_too_large" : "noise_too_small",
                                  length_text(free.noise_sigma_m), free.dimension, free.interval95.low,
                                  free.interval95.high));
  }
  add_scales(answer, remarks);
  const auto flagged = [&](const char* flag) { return has_flag(answer, flag); };
  if (flagged("smooth_short_lags"))
    remarks.emplace_back(
        "smooth_short_lags: interpolated, filtered or coarser than its points? Then D is not the ground's");
  if (flagged("rough_short_lags"))
    remarks.emplace_back("rough_short_lags: rounded, noisier than said, or not a surface (plants, walls)?");
  if (flagged("cell_size_unknown"))
    remarks.emplace_back(
        "cell_size_unknown: the file does not say how large its cells are; amplitude and scales are for 1 m");
  if (flagged("whole_metre_heights"))
    remarks.emplace_back("whole_metre_heights: rounding is a noise of 0.29 m (--noise-sigma-m)");
  if (report.input.frames && report.request.noise_sigma_m == 0.0 && !report.request.noise_auto)
    remarks.push_back(fmt::format("noise: the sensor's own model says --noise-sigma-m {:.2g} --noise-xy-sigma-m {:.2g}",
                                  report.input.frames->noise_sigma_m, report.input.frames->noise_xy_sigma_m));
  return remarks;
}

}  // namespace scree::node
