#include "io/loglog_plot.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace scree::io {
namespace {

std::vector<std::string> labels(const LogRange& range) {
  std::vector<std::string> out;
  for (const Tick& tick : log_ticks(range))
    if (!tick.label.empty()) out.push_back(tick.label);
  return out;
}

LogLogPlot line_plot() {
  LogLogPlot plot;
  plot.title = "title", plot.x_label = "distance / m", plot.y_label = "change / m";
  plot.marks.push_back({{{1.0, 0.1}, {10.0, 0.2}, {100.0, 0.5}}, true, "measured"});
  plot.lines.push_back({{{0.01, 1e-6}, {1e4, 1e6}}, {200, 0, 0}, false, "law"});
  plot.bands.push_back({{1.0, 100.0}, {0.01, 0.4}, {0.2, 90.0}, {250, 220, 210}, "band"});
  plot.spans.push_back({0.001, 10.0, "scales"});
  return plot;
}

TEST(LogLogPlot, TicksAreLabelledAtDecadesWhereThereAreEnough) {
  EXPECT_EQ(labels({0.03, 40.0}), (std::vector<std::string>{"0.1", "1", "10"}));
  EXPECT_EQ(labels({0.4, 3.0}), (std::vector<std::string>{"0.5", "1", "2"}));
  EXPECT_EQ(labels({2.5, 4.5}), (std::vector<std::string>{"3", "4"}));
  EXPECT_EQ(log_ticks({1.0, 100.0}).size(), 19u);
}

TEST(LogLogPlot, RangesHoldEveryMarkWithAMargin) {
  const auto plot = line_plot();
  const LogRange x = x_range(plot), y = y_range(plot);
  EXPECT_LT(x.low, 1.0);
  EXPECT_GT(x.high, 100.0);
  EXPECT_LT(x.high, 300.0);
  EXPECT_LT(y.low, 0.1);
  EXPECT_GT(y.high, 0.5);
  EXPECT_LT(y.high, 3.0);  // the line's end does not stretch the axis without limit
  EXPECT_NEAR(x.share(x.low), 0.0, 1e-12);
  EXPECT_NEAR(x.share(x.high), 1.0, 1e-12);
}

TEST(LogLogPlot, EverythingLiesInsideThePicture) {
  const Drawing drawing = draw_loglog_plot(line_plot());
  const auto inside = [&](const PixelPoint& p) {
    EXPECT_TRUE(p.x_px >= 0 && p.x_px <= drawing.width_px && p.y_px >= 0 && p.y_px <= drawing.height_px)
        << p.x_px << ' ' << p.y_px;
  };
  std::set<std::string> texts;
  int discs = 0;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* stroke = std::get_if<Stroke>(&shape))
      std::for_each(stroke->points.begin(), stroke->points.end(), inside);
    if (const auto* area = std::get_if<Area>(&shape)) std::for_each(area->corners.begin(), area->corners.end(), inside);
    if (const auto* disc = std::get_if<Disc>(&shape)) inside(disc->centre), ++discs;
    if (const auto* label = std::get_if<Label>(&shape)) inside(label->at), texts.insert(label->text);
  }
  EXPECT_EQ(discs, 4);  // three marks and the legend's
  for (const char* text : {"title", "distance / m", "change / m", "measured", "law", "band", "scales", "10"})
    EXPECT_TRUE(texts.contains(text)) << text;
}

TEST(LogLogPlot, AnEmptyPlotIsAFrame) {
  const Drawing drawing = draw_loglog_plot({});
  EXPECT_GT(drawing.height_px, 100);
  EXPECT_FALSE(drawing.shapes.empty());
}

TEST(LogLogPlot, LettersBeyondAsciiAreReplaced) {
  EXPECT_EQ(ascii_text("2 × 3 ± 1 …"), "2 x 3 +- 1 ...");
}

TEST(LogLogPlot, LongLabelsOfTheLegendHaveARowToThemselves) {
  LogLogPlot plot = line_plot();
  plot.lines.front().label = "a law that takes many words to say what it is";
  const auto y_of = [drawing = draw_loglog_plot(plot)](const std::string& text) {
    for (const Shape& shape : drawing.shapes)
      if (const auto* label = std::get_if<Label>(&shape); label != nullptr && label->text == text)
        return label->at.y_px;
    return -1.0;
  };
  const double law = y_of(plot.lines.front().label);
  EXPECT_GT(law, y_of("measured"));
  EXPECT_LT(law, y_of("band"));
  EXPECT_EQ(y_of("band"), y_of("scales"));
}

}  // namespace
}  // namespace scree::io
