#pragma once
// `--plot FILE.png`: height change against distance on logarithmic axes, with the law that was found.

#include <filesystem>
#include <string>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "io/loglog_plot.hpp"
#include "node/dimension_report.hpp"

namespace scree::node {

/// Measured changes by distance (those that the method's line was fitted to are filled), the law of the estimate, the
/// 95 % band of D about the shortest distance of the law, the law with the known noise where there is any, and the
/// scales that D is for, as [AK96] Fig. 9 shows them. `name` is the input's. Methods that take the plane off see their
/// points without it. Errors: those of the pair statistics.
Result<io::LogLogPlot> dimension_plot(const std::string& name, const DimensionReport& report, Executor& executor);

}  // namespace scree::node
