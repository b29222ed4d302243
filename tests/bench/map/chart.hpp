#pragma once
// Line charts with linear axes, as drawings.

#include <string>
#include <vector>

#include "io/drawing.hpp"

namespace scree::bench {

struct ChartLine {
  std::string label;
  std::vector<double> x, y;       ///< NaN breaks the line
  std::vector<double> low, high;  ///< of an interval at each x; empty: none
  io::Colour colour;
  bool dashed = false;
};

struct Chart {
  std::string title, x_label, y_label;
  double x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0;
  std::vector<ChartLine> lines;
};

/// Charts in rows of `across`, one legend (that of the first) below.
io::Drawing draw_charts(const std::vector<Chart>& charts, int across);

}  // namespace scree::bench
