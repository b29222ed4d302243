#include "node/dimension_plot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

#include "fractal/moment_dimension.hpp"
#include "node/length_text.hpp"

namespace scree::node {
namespace {

using fractal::LogLogPoint;

constexpr io::Colour kLaw{200, 60, 30}, kBand{248, 218, 205}, kNoisy{40, 90, 170}, kOther{120, 150, 60};

/// Heights above the survey's least-squares plane.
std::vector<double> above_plane(const SurveyInput& input) {
  double n = 0, x = 0, y = 0, z = 0;
  for (std::size_t i = 0; i < input.z_m.size(); ++i) ++n, x += input.x_m[i], y += input.y_m[i], z += input.z_m[i];
  x /= n, y /= n, z /= n;
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (std::size_t i = 0; i < input.z_m.size(); ++i) {
    const double dx = input.x_m[i] - x, dy = input.y_m[i] - y, dz = input.z_m[i] - z;
    xx += dx * dx, xy += dx * dy, yy += dy * dy, xz += dx * dz, yz += dy * dz;
  }
  const double determinant = xx * yy - xy * xy;
  const double slope_x = (xz * yy - yz * xy) / determinant, slope_y = (yz * xx - xz * xy) / determinant;
  std::vector<double> heights(input.z_m.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = input.z_m[i] - z - slope_x * (input.x_m[i] - x) - slope_y * (input.y_m[i] - y);
  return heights;
}

/// The points that a likelihood has no need of.
Result<std::vector<LogLogPoint>> level_points(const DimensionReport& report, Executor& executor) {
  const std::vector<double> heights = above_plane(report.input);
  const fractal::SurveyPoints survey{.x_m = report.input.x_m, .y_m = report.input.y_m, .z_m = heights};
  fractal::MomentOptions options;
  options.moment = fractal::Moment::second;
  options.max_lag_m = report.request.max_lag_m;
  options.seed = report.request.seed;
  auto found = fractal::estimate_dimension_moment(survey, options, executor);
  if (!found) return found.error();
  return std::move(found->points);
}

/// The law's change at a distance; E|z| = σ·√(2/π) for Gaussian differences.
struct Law {
  double dimension, amplitude_m, factor = 1.0, noise_m = 0.0;
  double at(double lag_m) const {
    const double ground = amplitude_m * std::pow(lag_m, 3.0 - dimension);
    return factor * std::sqrt(ground * ground + 2.0 * noise_m * noise_m);
  }
};

std::vector<double> distances(const std::vector<LogLogPoint>& points) {
  constexpr int kSteps = 60;
  const double low = points.front().log_lag - 0.3, high = points.back().log_lag + 0.3;
  std::vector<double> out;
  for (int i = 0; i <= kSteps; ++i) out.push_back(std::exp(low + (high - low) * i / kSteps));
  return out;
}

io::PlotLine line_of(const Law& law, const std::vector<double>& lags_m) {
  io::PlotLine line;
  for (const double lag : lags_m) line.points.push_back({lag, law.at(lag)});
  return line;
}

/// Laws with the ends of the interval, which agree where the amplitude is known best: at the shortest distances.
io::PlotBand band_of(const Law& law, const fractal::Interval& interval, double pivot_m,
                     const std::vector<double>& lags_m) {
  io::PlotBand band;
  band.x = lags_m;
  for (const double lag : lags_m) {
    const auto with = [&](double dimension) { return law.at(pivot_m) * std::pow(lag / pivot_m, 3.0 - dimension); };
    band.low.push_back(std::min(with(interval.low), with(interval.high)));
    band.high.push_back(std::max(with(interval.low), with(interval.high)));
  }
  band.colour = kBand;
  band.label = fmt::format("95 %: D = {:.3f} ... {:.3f}", interval.low, interval.high);
  return band;
}

/// Where the law's height is known best: among the shortest distances, or in the middle of an unweighted line.
double pivot_of(const DimensionAnswer& answer) {
  const auto& range = answer.scale_range_m;
  if (!std::isfinite(range.low)) return answer.estimate.spacing_m;
  return answer.raw_heights ? std::sqrt(range.low * range.high) : range.low;
}

void add_marks(const std::vector<LogLogPoint>& points, const DimensionReport& report, io::LogLogPlot& plot) {
  const bool fitted = report.answer.raw_heights;
  const auto& range = report.answer.scale_range_m;
  io::PlotMarks used{{}, true, fitted ? "fitted" : "measured, plane taken off"}, others{{}, false, ""};
  for (const LogLogPoint& p : points) {
    const double lag = std::exp(p.log_lag);
    const bool inside = !fitted || (lag > range.low * 0.999 && lag < range.high * 1.001);
    (inside ? used : others).points.push_back({lag, std::exp(p.log_change)});
  }
  if (!others.points.empty()) others.label = "measured, beyond the linear part";
  plot.marks = {used, others};
}

void add_law(const std::vector<double>& lags_m, const DimensionReport& report, io::LogLogPlot& plot) {
  const auto& estimate = report.answer.estimate;
  if (!std::isfinite(estimate.dimension)) return;
  const double factor =
      report.answer.plot_moment == fractal::Moment::first_absolute ? std::sqrt(2.0 / std::numbers::pi) : 1.0;
  const Law law{estimate.dimension, estimate.amplitude_m, factor};
  if (report.answer.has_interval)
    plot.bands.push_back(band_of(law, estimate.interval95, pivot_of(report.answer), lags_m));
  plot.lines.push_back(line_of(law, lags_m));
  plot.lines.back().colour = kLaw;
  plot.lines.back().label =
      fmt::format("D = {:.3f}, {} m at 1 m", estimate.dimension, length_text(estimate.amplitude_m));
  const bool one_law = !report.answer.scales || report.answer.scales->best().law == fractal::ScaleLaw::power;
  const double least = law.at(lags_m.front());
  if (report.answer.raw_heights || !one_law || report.answer.noise_sigma_m < 0.05 * least) return;
  Law noisy = law;
  noisy.noise_m = report.answer.noise_sigma_m;
  plot.lines.push_back(line_of(noisy, lags_m));
  plot.lines.back().colour = kNoisy;
  plot.lines.back().dashed = true;
  plot.lines.back().label = "with noise " + length_text(noisy.noise_m) + " m";
}

/// The other method's law, where the two disagree.
void add_check(const DimensionAnswer& answer, const std::vector<double>& lags_m, io::LogLogPlot& plot) {
  if (!answer.check || !answer.agreement.comparable || answer.agreement.agree) return;
  plot.lines.push_back(line_of({answer.check->dimension, answer.check->amplitude_m}, lags_m));
  plot.lines.back().colour = kOther;
  plot.lines.back().label = fmt::format("{}: D = {:.3f}", answer.check->method, answer.check->dimension);
}

/// What the structure function asks for instead of one power law.
void add_scales(const fractal::ScaleAnalysis& scales, io::LogLogPlot& plot) {
  const auto& best = scales.best();
  if (best.law == fractal::ScaleLaw::power) return;
  io::PlotLine line{{}, kNoisy, true, ""};
  for (std::size_t i = 0; i < scales.points.size(); ++i)
    line.points.push_back({std::exp(scales.points[i].log_lag), std::exp(scales.log_model[i])});
  line.label = fmt::format("D = {:.3f}, ", best.dimension);
  if (best.law == fractal::ScaleLaw::two_scales)
    line.label += fmt::format("{:.3f} from {} m", best.coarse_dimension, length_text(best.crossover_m));
  else if (best.law == fractal::ScaleLaw::plateau)
    line.label += fmt::format("plateau from {} m", length_text(best.crossover_m));
  else
    line.label += fmt::format("noise {} m more", length_text(best.noise_sigma_m));
  plot.lines.push_back(std::move(line));
}

}  // namespace

Result<io::LogLogPlot> dimension_plot(const std::string& name, const DimensionReport& report, Executor& executor) {
  const DimensionAnswer& answer = report.answer;
  std::vector<LogLogPoint> points = answer.scales ? answer.scales->points : answer.plot_points;
  if (points.empty()) {
    auto level = level_points(report, executor);
    if (!level) return level.error();
    points = *std::move(level);
  }
  io::LogLogPlot plot;
  const bool mean = answer.plot_moment == fractal::Moment::first_absolute;
  plot.title = name;
  plot.subtitle = fmt::format("{}, {} {}", answer.estimate.method, answer.estimate.points,
                              report.input.cells() ? "cells" : "points");
  plot.x_label = "distance / m";
  plot.y_label = mean ? "mean |height change| / m" : "rms height change / m";
  const auto& range = answer.scale_range_m;
  if (std::isfinite(range.low))
    plot.spans.push_back({range.low, range.high, "scales: " + range_text(range.low, range.high)});
  add_marks(points, report, plot);
  add_law(distances(points), report, plot);
  add_check(answer, distances(points), plot);
  if (answer.scales) add_scales(*answer.scales, plot);
  return plot;
}

}  // namespace scree::node
