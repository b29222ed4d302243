#include "io/loglog_plot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree::io {
namespace {

constexpr double kWidth = 760, kLeft = 84, kRight = 28, kTop = 78, kBox = 430, kBelow = 58, kRow = 22;
constexpr Colour kAxis{40, 40, 40}, kGrid{226, 226, 226}, kSpan{240, 243, 247};

/// Plot coordinates to pixels, cut at the frame.
struct Frame {
  LogRange x, y;
  double left = kLeft, right = kWidth - kRight, top = kTop, bottom = kTop + kBox;

  double x_px(double value) const { return left + std::clamp(x.share(value), 0.0, 1.0) * (right - left); }
  double y_px(double value) const { return bottom - std::clamp(y.share(value), 0.0, 1.0) * (bottom - top); }
  PixelPoint at(double x_value, double y_value) const { return {x_px(x_value), y_px(y_value)}; }
};

/// The part of segment a–b (shares of the axes) inside the unit square. Source: Liang and Barsky.
bool cut_segment(double& ax, double& ay, double& bx, double& by) {
  double enter = 0.0, leave = 1.0;
  const double dx = bx - ax, dy = by - ay;
  for (const auto& [step, room] :
       {std::pair(-dx, ax), std::pair(dx, 1.0 - ax), std::pair(-dy, ay), std::pair(dy, 1.0 - ay)}) {
    if (step == 0.0 && room < 0.0) return false;
    if (step < 0.0) enter = std::max(enter, room / step);
    if (step > 0.0) leave = std::min(leave, room / step);
  }
  if (enter > leave) return false;
  bx = ax + leave * dx, by = ay + leave * dy;
  ax += enter * dx, ay += enter * dy;
  return true;
}

/// Pieces of a line within the frame.
void add_line(const Frame& frame, const PlotLine& line, std::vector<Shape>& shapes) {
  Stroke stroke{{}, line.colour, line.dashed ? 1.4 : 2.0, line.dashed};
  const auto flush = [&] {
    if (stroke.points.size() > 1) shapes.emplace_back(stroke);
    stroke.points.clear();
  };
  const auto pixel = [&](double x, double y) {
    return PixelPoint{frame.left + x * (frame.right - frame.left), frame.bottom - y * (frame.bottom - frame.top)};
  };
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    double ax = frame.x.share(line.points[i - 1].x), ay = frame.y.share(line.points[i - 1].y);
    double bx = frame.x.share(line.points[i].x), by = frame.y.share(line.points[i].y);
    if (!cut_segment(ax, ay, bx, by)) {
      flush();
      continue;
    }
    if (stroke.points.empty()) stroke.points.push_back(pixel(ax, ay));
    stroke.points.push_back(pixel(bx, by));
    if (bx < frame.x.share(line.points[i].x) - 1e-9) flush();
  }
  flush();
}

void add_band(const Frame& frame, const PlotBand& band, std::vector<Shape>& shapes) {
  Area area{{}, band.colour};
  for (std::size_t i = 0; i < band.x.size(); ++i) area.corners.push_back(frame.at(band.x[i], band.high[i]));
  for (std::size_t i = band.x.size(); i-- > 0;) area.corners.push_back(frame.at(band.x[i], band.low[i]));
  if (area.corners.size() > 2) shapes.emplace_back(std::move(area));
}

void add_box(const Frame& frame, double x_min, double x_max, Colour colour, std::vector<Shape>& shapes) {
  shapes.emplace_back(
      Area{{{x_min, frame.top}, {x_max, frame.top}, {x_max, frame.bottom}, {x_min, frame.bottom}}, colour});
}

void add_grid(const Frame& frame, std::vector<Shape>& shapes) {
  for (const Tick& tick : log_ticks(frame.x))
    if (!tick.label.empty())
      shapes.emplace_back(Stroke{{{frame.x_px(tick.value), frame.top}, {frame.x_px(tick.value), frame.bottom}}, kGrid});
  for (const Tick& tick : log_ticks(frame.y))
    if (!tick.label.empty())
      shapes.emplace_back(Stroke{{{frame.left, frame.y_px(tick.value)}, {frame.right, frame.y_px(tick.value)}}, kGrid});
}

void add_axes(const Frame& frame, const LogLogPlot& plot, std::vector<Shape>& shapes) {
  shapes.emplace_back(Stroke{{{frame.left, frame.top},
                              {frame.right, frame.top},
                              {frame.right, frame.bottom},
                              {frame.left, frame.bottom},
                              {frame.left, frame.top}},
                             kAxis});
  for (const Tick& tick : log_ticks(frame.x)) {
    const double x = frame.x_px(tick.value), length = tick.label.empty() ? 4 : 7;
    shapes.emplace_back(Stroke{{{x, frame.bottom}, {x, frame.bottom - length}}, kAxis});
    if (!tick.label.empty()) shapes.emplace_back(Label{tick.label, {x, frame.bottom + 19}, Align::centre});
  }
  for (const Tick& tick : log_ticks(frame.y)) {
    const double y = frame.y_px(tick.value), length = tick.label.empty() ? 4 : 7;
    shapes.emplace_back(Stroke{{{frame.left, y}, {frame.left + length, y}}, kAxis});
    if (!tick.label.empty()) shapes.emplace_back(Label{tick.label, {frame.left - 8, y + 5}, Align::right});
  }
  const double middle = 0.5 * (frame.left + frame.right);
  shapes.emplace_back(Label{plot.x_label, {middle, frame.bottom + 44}, Align::centre});
  shapes.emplace_back(Label{plot.y_label, {12, frame.top - 10}});
  shapes.emplace_back(Label{plot.title, {kWidth / 2, 26}, Align::centre, 1.25});
  shapes.emplace_back(Label{plot.subtitle, {kWidth / 2, 48}, Align::centre});
}

/// Rows of a swatch and its text, left to right in two columns; a text too long for one has a row to itself.
class Legend {
 public:
  Legend(double top, std::vector<Shape>& shapes) : top_(top), shapes_(shapes) {}
  template <class Swatch>
  void add(const std::string& label, const Swatch& swatch) {
    if (label.empty()) return;
    constexpr double kColumn = 0.5 * (kWidth - kLeft - kRight), kText = 42, kLetter = 9.2;
    const bool wide = kText + kLetter * static_cast<double>(label.size()) > kColumn;
    if (wide) places_ += places_ % 2;
    const double x = kLeft + (places_ % 2 == 0 ? 0.0 : kColumn), y = top_ + kRow * (places_ / 2);
    swatch(x, y);
    shapes_.emplace_back(Label{label, {x + kText, y + 5}});
    places_ += wide ? 2 : 1;
  }
  double bottom() const { return top_ + kRow * ((places_ + 1) / 2); }

 private:
  double top_;
  std::vector<Shape>& shapes_;
  int places_ = 0;  ///< taken, two a row
};

double add_legend(const Frame& frame, const LogLogPlot& plot, std::vector<Shape>& shapes) {
  Legend legend(frame.bottom + kBelow + 14, shapes);
  const auto box = [&](Colour colour) {
    return [&shapes, colour](double x, double y) {
      shapes.emplace_back(Area{{{x, y - 7}, {x + 32, y - 7}, {x + 32, y + 7}, {x, y + 7}}, colour});
    };
  };
  for (const auto& marks : plot.marks)
    legend.add(marks.label, [&](double x, double y) {
      shapes.emplace_back(Disc{{x + 16, y}, 3.5, kAxis, marks.filled});
    });
  for (const auto& line : plot.lines)
    legend.add(line.label, [&](double x, double y) {
      shapes.emplace_back(Stroke{{{x, y}, {x + 32, y}}, line.colour, line.dashed ? 1.4 : 2.0, line.dashed});
    });
  for (const auto& band : plot.bands) legend.add(band.label, box(band.colour));
  for (const auto& span : plot.spans) legend.add(span.label, box(kSpan));
  return legend.bottom();
}

}  // namespace

LogRange x_range(const LogLogPlot& plot) {
  double low = INFINITY, high = 0.0;
  for (const auto& marks : plot.marks)
    for (const auto& p : marks.points) low = std::min(low, p.x), high = std::max(high, p.x);
  return high > 0.0 ? widened(low, high, 0.06) : LogRange{};
}

LogRange y_range(const LogLogPlot& plot) {
  double low = INFINITY, high = 0.0;
  for (const auto& marks : plot.marks)
    for (const auto& p : marks.points) low = std::min(low, p.y), high = std::max(high, p.y);
  if (high == 0.0) return {};
  const double least = low / 3.0, most = high * 3.0;
  for (const auto& line : plot.lines)
    for (const auto& p : line.points)
      low = std::min(low, std::max(p.y, least)), high = std::max(high, std::min(p.y, most));
  return widened(low, high, 0.06);
}

Drawing draw_loglog_plot(const LogLogPlot& plot) {
  Drawing drawing{static_cast<int>(kWidth), 0, {}};
  const Frame frame{x_range(plot), y_range(plot)};
  auto& shapes = drawing.shapes;
  for (const auto& span : plot.spans) add_box(frame, frame.x_px(span.x_min), frame.x_px(span.x_max), kSpan, shapes);
  for (const auto& band : plot.bands) add_band(frame, band, shapes);
  add_grid(frame, shapes);
  for (const auto& line : plot.lines) add_line(frame, line, shapes);
  for (const auto& marks : plot.marks)
    for (const auto& p : marks.points) shapes.emplace_back(Disc{frame.at(p.x, p.y), 3.5, kAxis, marks.filled});
  add_axes(frame, plot, shapes);
  drawing.height_px = static_cast<int>(add_legend(frame, plot, shapes)) + 10;
  return drawing;
}

}  // namespace scree::io
