#pragma once
// A log–log plot as a drawing: where everything goes, without a library.

#include <string>
#include <vector>

#include "io/drawing.hpp"
#include "io/log_axis.hpp"

namespace scree::io {

/// Both > 0.
struct PlotPoint {
  double x = 0.0, y = 0.0;
};

struct PlotMarks {
  std::vector<PlotPoint> points;
  bool filled = true;
  std::string label;
};

struct PlotLine {
  std::vector<PlotPoint> points;  ///< in order of x
  Colour colour;
  bool dashed = false;
  std::string label;  ///< empty: not in the legend
};

/// Between two curves over the same x.
struct PlotBand {
  std::vector<double> x, low, high;
  Colour colour;
  std::string label;
};

/// A stretch of the x axis, shaded.
struct PlotSpan {
  double x_min = 0.0, x_max = 0.0;
  std::string label;
};

struct LogLogPlot {
  std::string title, subtitle;
  std::string x_label, y_label;  ///< with units
  std::vector<PlotSpan> spans;
  std::vector<PlotBand> bands;
  std::vector<PlotLine> lines;
  std::vector<PlotMarks> marks;
};

/// The range of all marks and, on y, of lines within a factor of 3 of them: curves are cut at the frame.
LogRange x_range(const LogLogPlot& plot);
LogRange y_range(const LogLogPlot& plot);

/// Axes with ticks, labels and a grid, everything of the plot inside the frame, the legend below it.
Drawing draw_loglog_plot(const LogLogPlot& plot);

}  // namespace scree::io
