#pragma once
// The numbers behind the plot of `scree dimension`.

#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/loglog_fit.hpp"
#include "node/dimension_report.hpp"

namespace scree::node {

/// Natural logarithms of metres, at the distances of `points`.
struct DimensionPlotData {
  std::vector<fractal::LogLogPoint> points;  ///< measured, comparable with the law of the estimate (law_picture.hpp)
  std::vector<double> log_check;             ///< the other method's law; empty where the two agree
  std::vector<double> log_scales;            ///< what the structure function asks for; empty for one power law
};

/// Errors: those of the pair statistics.
Result<DimensionPlotData> dimension_plot_data(const DimensionReport& report, Executor& executor);

}  // namespace scree::node
