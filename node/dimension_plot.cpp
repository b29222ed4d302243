#include "node/dimension_plot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

#include "node/dimension_plot_data.hpp"
#include "node/dimension_scales.hpp"
#include "node/length_text.hpp"

namespace scree::node {
namespace {

using fractal::LogLogPoint;

constexpr io::Colour kLaw{200, 60, 30}, kBand{248, 218, 205}, kNoisy{40, 90, 170}, kOther{120, 150, 60};

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
  band.label = "95 %: slope only";  // no width at the pivot: the height's own doubt is not in it
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
  io::PlotMarks used{{}, true, fitted ? "fitted" : "measured, tilt taken out"}, others{{}, false, ""};
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

io::PlotLine line_through(const std::vector<LogLogPoint>& points, const std::vector<double>& log_changes,
                          io::Colour colour) {
  io::PlotLine line{{}, colour, false, ""};
  for (std::size_t i = 0; i < log_changes.size(); ++i)
    line.points.push_back({std::exp(points[i].log_lag), std::exp(log_changes[i])});
  return line;
}

/// The other method's law, where the two disagree.
void add_check(const DimensionAnswer& answer, const DimensionPlotData& data, io::LogLogPlot& plot) {
  if (data.log_check.empty()) return;
  plot.lines.push_back(line_through(data.points, data.log_check, kOther));
  plot.lines.back().label = fmt::format("{}: D = {:.3f}", answer.check->method, answer.check->dimension);
}

/// What the structure function asks for instead of one power law.
void add_scales(const DimensionAnswer& answer, const DimensionPlotData& data, io::LogLogPlot& plot) {
  if (data.log_scales.empty()) return;
  const auto& best = answer.scales->best();
  io::PlotLine line = line_through(data.points, data.log_scales, kNoisy);
  line.dashed = true;
  line.label = fmt::format("D = {:.3f}, ", best.dimension);
  if (best.law == fractal::ScaleLaw::two_scales)
    line.label += fmt::format("{:.3f} from {}", best.coarse_dimension, crossover_text(best));
  else if (best.law == fractal::ScaleLaw::plateau)
    line.label += fmt::format("plateau from {}", crossover_text(best));
  else
    line.label += fmt::format("noise {} m more", length_text(best.noise_sigma_m));
  plot.lines.push_back(std::move(line));
}

}  // namespace

Result<io::LogLogPlot> dimension_plot(const std::string& name, const DimensionReport& report, Executor& executor) {
  const DimensionAnswer& answer = report.answer;
  const auto data = dimension_plot_data(report, executor);
  if (!data) return data.error();
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
  add_marks(data->points, report, plot);
  add_law(distances(data->points), report, plot);
  add_check(answer, *data, plot);
  add_scales(answer, *data, plot);
  return plot;
}

}  // namespace scree::node
