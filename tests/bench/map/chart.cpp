#include "tests/bench/map/chart.hpp"

#include <algorithm>
#include <cmath>

#include "io/picture_layout.hpp"

namespace scree::bench {
namespace {

constexpr double kLeft = 80, kTop = 62, kWidth = 400, kHeight = 290, kBelow = 64, kRight = 24;
constexpr io::Colour kAxis{40, 40, 40}, kGridLine{226, 226, 226};

class ChartDrawing {
 public:
  ChartDrawing(const Chart& chart, io::PixelPoint corner, std::vector<io::Shape>& shapes)
      : chart_(chart), left_(corner.x_px + kLeft), top_(corner.y_px + kTop), shapes_(shapes) {}

  void draw() {
    axes();
    for (const ChartLine& line : chart_.lines) draw_line(line);
    const double bottom = top_ + kHeight, middle = left_ + 0.5 * kWidth;
    shapes_.emplace_back(io::Label{chart_.title, {middle, top_ - 32}, io::Align::centre, 1.15});
    shapes_.emplace_back(io::Label{chart_.y_label, {left_ - 60, top_ - 10}});
    shapes_.emplace_back(io::Label{chart_.x_label, {middle, bottom + 44}, io::Align::centre});
  }

 private:
  double x_px(double x) const { return left_ + kWidth * (x - chart_.x_min) / (chart_.x_max - chart_.x_min); }
  double y_px(double y) const {
    const double share = (y - chart_.y_min) / (chart_.y_max - chart_.y_min);
    return top_ + kHeight * (1.0 - std::clamp(share, 0.0, 1.0));
  }

  void axes() {
    const double bottom = top_ + kHeight, right = left_ + kWidth;
    for (const io::Tick& tick : io::ticks(chart_.x_min, chart_.x_max, 9)) {
      shapes_.emplace_back(io::Stroke{{{x_px(tick.value), top_}, {x_px(tick.value), bottom}}, kGridLine});
      shapes_.emplace_back(io::Label{tick.label, {x_px(tick.value), bottom + 19}, io::Align::centre});
    }
    for (const io::Tick& tick : io::ticks(chart_.y_min, chart_.y_max, 7)) {
      shapes_.emplace_back(io::Stroke{{{left_, y_px(tick.value)}, {right, y_px(tick.value)}}, kGridLine});
      shapes_.emplace_back(io::Label{tick.label, {left_ - 8, y_px(tick.value) + 5}, io::Align::right});
    }
    shapes_.emplace_back(
        io::Stroke{{{left_, top_}, {right, top_}, {right, bottom}, {left_, bottom}, {left_, top_}}, kAxis});
  }

  void draw_line(const ChartLine& line) {
    io::Stroke stroke{{}, line.colour, line.dashed ? 1.5 : 2.2, line.dashed};
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (std::isnan(line.y[i])) continue;
      stroke.points.push_back({x_px(line.x[i]), y_px(line.y[i])});
      if (!line.low.empty())
        shapes_.emplace_back(
            io::Stroke{{{x_px(line.x[i]), y_px(line.low[i])}, {x_px(line.x[i]), y_px(line.high[i])}}, line.colour});
    }
    if (stroke.points.size() > 1) shapes_.emplace_back(std::move(stroke));
  }

  const Chart& chart_;
  double left_, top_;
  std::vector<io::Shape>& shapes_;
};

}  // namespace

io::Drawing draw_charts(const std::vector<Chart>& charts, int across) {
  const double wide = kLeft + kWidth + kRight, high = kTop + kHeight + kBelow;
  const auto rows = (charts.size() + static_cast<std::size_t>(across) - 1) / static_cast<std::size_t>(across);
  io::Drawing out;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(across));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(across));
    ChartDrawing(charts[i], {column * wide, row * high}, out.shapes).draw();
  }
  double y = static_cast<double>(rows) * high + 18;
  for (const ChartLine& line : charts.front().lines) {
    out.shapes.emplace_back(
        io::Stroke{{{kLeft, y}, {kLeft + 40, y}}, line.colour, line.dashed ? 1.5 : 2.2, line.dashed});
    out.shapes.emplace_back(io::Label{line.label, {kLeft + 52, y + 5}});
    y += 24;
  }
  out.width_px = static_cast<int>(across * wide);
  out.height_px = static_cast<int>(y) + 8;
  return out;
}

}  // namespace scree::bench
