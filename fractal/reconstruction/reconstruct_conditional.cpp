#include "fractal/reconstruction/reconstruct_conditional.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "fractal/reconstruction/conditional_run.hpp"
#include "fractal/reconstruction/distance_transform.hpp"
#include "fractal/reconstruction/multigrid.hpp"
#include "fractal/reconstruction/outlier_gate.hpp"
#include "fractal/reconstruction/residual_fields.hpp"
#include "fractal/reconstruction/surface_checks.hpp"

namespace scree::fractal {
namespace {

constexpr double kMostOutliers = 0.25;  ///< share of the measured cells

/// A ceiling that no ground of the law reaches from the lowest datum is none: a nodata value, or another unit.
Status check_ceilings(const CellSamples& samples, const SurfaceRequest& request, const Grid<float>& ceiling_m) {
  const auto& [rows, columns, cell_m] = request.grid;
  if (ceiling_m.empty()) return {};
  if (ceiling_m.rows() != rows || ceiling_m.columns() != columns)
    return Error{ErrorKind::usage,
                 fmt::format("conditional: expected a ceiling for each of {} x {} cells or none, found {} x {}", rows,
                             columns, ceiling_m.rows(), ceiling_m.columns())};
  constexpr double kFarBelow = 10.0;
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const float height : samples.height_m)
    if (std::isfinite(height)) lowest_m = std::min(lowest_m, static_cast<double>(height));
  const double least_m = lowest_m - kFarBelow * request.law.law.rms_change_m(cell_m * std::hypot(rows, columns));
  for (std::size_t i = 0; i < ceiling_m.size(); ++i)
    if (static_cast<double>(ceiling_m[i]) < least_m)  // -inf too
      return Error{ErrorKind::bad_data,
                   fmt::format("conditional: expected ceilings that ground with its lowest sample at {:g} m can stand "
                               "below, found {:g} m in cell ({}, {}): a nodata value?",
                               lowest_m, ceiling_m[i], i / static_cast<std::size_t>(columns),
                               i % static_cast<std::size_t>(columns))};
  return {};
}

Status check(const CellSamples& samples, const SurfaceRequest& request, const ConditionalOptions& options) {
  if (Status status = check_surface("conditional", samples, request); !status) return status;
  const SurfaceGrid& grid = request.grid;
  if (options.residual_fields < 1)
    return Error{ErrorKind::usage,
                 fmt::format("conditional: expected at least 1 residual field, found {}", options.residual_fields)};
  if (std::max(grid.rows, grid.columns) > DistanceTransform::kMaxSide)
    return Error{ErrorKind::usage, fmt::format("conditional: expected at most {} cells a side, found {} x {}",
                                               DistanceTransform::kMaxSide, grid.rows, grid.columns)};
  if (Status status = check_ceilings(samples, request, options.ceiling_m); !status) return status;
  const LawMap& law = request.law;
  if (!law.varies()) return {};
  for (const Grid<float>* map : {&law.dimension, &law.amplitude_m})
    if (map->rows() != grid.rows || map->columns() != grid.columns)
      return Error{ErrorKind::usage, fmt::format("conditional: expected a law for each of {} x {} cells, found {} x {}",
                                                 grid.rows, grid.columns, map->rows(), map->columns())};
  for (std::size_t i = 0; i < law.dimension.size(); ++i)
    if (!(law.dimension[i] > 2.0F && law.dimension[i] < 3.0F && law.amplitude_m[i] > 0.0F &&
          std::isfinite(law.amplitude_m[i])))
      return Error{ErrorKind::bad_data,
                   fmt::format("conditional: expected 2 < D < 3 and a finite amplitude > 0 m in cell ({}, {}), found "
                               "D = {} and {} m",
                               i / static_cast<std::size_t>(grid.columns), i % static_cast<std::size_t>(grid.columns),
                               law.dimension[i], law.amplitude_m[i])};
  return {};
}

}  // namespace

Result<SurfaceEstimate> reconstruct_conditional(const CellSamples& samples, const SurfaceRequest& request,
                                                const ConditionalOptions& options, Executor& executor) {
  if (Status status = check(samples, request, options); !status) return status.error();
  if (!options.gate_outliers) return ConditionalRun(samples, request, options).run(executor);
  OutlierReport report = find_outliers(samples, request.grid.cell_m, request.law);
  // Where that many data are no ground of the law, it is the law that is wrong: nothing may be left out in its name.
  const bool contradicted = static_cast<double>(report.count) > kMostOutliers * static_cast<double>(report.tested);
  const bool gated = report.count > 0 && !contradicted;
  SurfaceEstimate estimate = gated ? ConditionalRun(without_outliers(samples, report), request, options).run(executor)
                                   : ConditionalRun(samples, request, options).run(executor);
  estimate.iterations += report.iterations;
  estimate.law_contradicted = contradicted;
  if (gated) {
    estimate.rejected = std::move(report.rejected);
    estimate.rejected_cells = report.count;
  }
  return estimate;
}

std::size_t conditional_memory_bytes(int rows, int columns, bool law_varies, const ConditionalLoad& load) {
  const MultigridShape shape(rows, columns);
  const auto cells = static_cast<double>(shape.rows) * shape.columns;
  const double side = residual_torus_side(
      0.95, shape.rows, shape.columns, load.gap_cells >= 0 ? load.gap_cells : std::max(shape.rows, shape.columns) / 32);
  const double together = cells > static_cast<double>(ConditionalRun::kSideBySide) ? 1.0 : ConditionalRun::kTogether;
  const double levels = 4.0 / 3.0;
  const double held = 10.0 + 11.0 + 4.0 * 4.0 + (law_varies ? 8.0 : 0.0);  // samples, gated; mean … sd; law
  const double matrix = 8.0 + 8.0 * levels + (law_varies ? 8.0 + 16.0 * levels : 0.0);
  const double amplitudes = law_varies ? 17.4 + 8.0 * levels + 12.0 : 0.0;  // of bands, the law's pyramid, scratch
  const double solve = 4.0 * (3.0 + 4.0) + 8.0 / 3.0;                       // u b x, r z p q, coarse levels
  const double synthesis = 4.0 * cells + 4.0 * side * shape.columns + (law_varies ? 4.0 : 2.0) * side * side;
  const double solving = cells * (held + matrix + amplitudes + together * solve) + together * synthesis;
  const double deviations = cells * (held + 60.0);  // SdMap
  const double kept = cells * (4.0 * load.kept_draws + (load.ceilings ? 90.0 : 0.0));
  return static_cast<std::size_t>(std::max(solving, deviations) + kept);
}

}  // namespace scree::fractal
