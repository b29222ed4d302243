#include "fractal/reconstruction/conditional_frames.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "fractal/fourier.hpp"
#include "fractal/reconstruction/cold_start.hpp"

namespace scree::fractal {

ConditionalReconstructor::Solver::Solver(const ReconstructionConfig& c)
    : config(c),
      tiles(c.seed, smooth_even_size(std::max(64, c.max_cells + c.max_cells / 2))),
      kept(static_cast<std::size_t>(std::max(1, c.residual_fields)) + 1),
      reports(kept.size()),
      pushes(kept.size() - 1),
      pushed(pushes.size(), 0) {}

void ConditionalReconstructor::Solver::prepare_fields(const LawMap& law) {
  varies = law.varies();
  if (!varies) return tiles.prepare(problem.dimension(), fields());
  tiles.prepare_noise(fields());
  if (!bands) bands = std::make_unique<BandTiles>(config.seed, config.max_cells);
  bands->prepare(fields());
  amplitudes.set(law, window, problem.unit_m(), config.cell_m, BandTiles::kBands);
}

void ConditionalReconstructor::Solver::start_mean(const Grid<float>& height_m, Workspace& work) const {
  const MultigridShape& shape = problem.shape();
  const auto scale = static_cast<float>(1.0 / problem.unit_m()), level = static_cast<float>(problem.level_m());
  problem.mean_problem(height_m, work.b);
  if (!kept.front().overlaps(window.min, shape.rows, shape.columns)) return work.x.resize(shape.rows, shape.columns);
  work.x.reshape(shape.rows, shape.columns);
  for (int r = 0; r < shape.rows; ++r) {
    float* x = work.x.row(r);
    kept.front().shifted_row(window.min, r, shape.columns, x);
    for (int i = 0; i < shape.columns; ++i) x[i] = scale * (x[i] - level);
  }
}

/// First guess u − last residual: what changes from frame to frame is little. In the margin u is a copy of the border.
/// Returns the tolerance of the solve.
double ConditionalReconstructor::Solver::start_residual(int k, Workspace& work) const {
  const MultigridShape& shape = problem.shape();
  const CellIndex min = window.min, centre{min.x + shape.columns / 2, min.y + shape.rows / 2};
  for (PaddedField* field : {&work.u, &work.b}) field->reshape(shape.rows, shape.columns);
  if (varies) bands->make_field(amplitudes, k, work.bands, work.u);
  for (int r = 0; r < shape.rows; ++r) {
    float* u = work.u.row(r);
    if (!varies) {
      tiles.surface_row(problem.dimension(), k, {min.x, min.y + r}, centre, shape.columns, u);
    } else if (r < window.rows) {
      std::fill_n(u + window.columns, shape.columns - window.columns, u[window.columns - 1]);
    } else {
      std::copy_n(work.u.row(window.rows - 1), shape.columns, u);
    }
    tiles.noise_row(k, {min.x, min.y + r}, shape.columns, work.b.row(r));
  }
  problem.residual_problem(work.u, work.b);
  const KeptSolution& last = kept[static_cast<std::size_t>(k) + 1];
  if (!last.overlaps(window.min, shape.rows, shape.columns)) {
    start_from_means(work.u, problem.spacing_cells(), work.x);
    return problem.cold_tolerance(config.tolerance);
  }
  work.x.reshape(shape.rows, shape.columns);
  const auto scale = static_cast<float>(1.0 / problem.unit_m());
  for (int r = 0; r < shape.rows; ++r) {
    float* x = work.x.row(r);
    const float* u = work.u.row(r);
    last.shifted_row(window.min, r, shape.columns, x);
    for (int i = 0; i < shape.columns; ++i) x[i] = u[i] - scale * x[i];
  }
  return problem.tolerance(config.tolerance);
}

void ConditionalReconstructor::Solver::keep(int task, const Workspace& work) {
  KeptSolution& solution = kept[static_cast<std::size_t>(task)];
  const MultigridShape& shape = problem.shape();
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  solution.min = window.min;
  solution.valid = true;
  solution.values.reshape(shape.rows, shape.columns);
  for (int r = 0; r < shape.rows; ++r) {
    const float *x = work.x.row(r), *u = task == 0 ? x : work.u.row(r);
    float* out = solution.values.row(r);
    if (task == 0)
      for (int i = 0; i < shape.columns; ++i) out[i] = level + unit * x[i];
    else
      for (int i = 0; i < shape.columns; ++i) out[i] = unit * (u[i] - x[i]);
  }
}

void ConditionalReconstructor::Solver::solve(int task, const Grid<float>& height_m) {
  std::unique_ptr<Workspace> work = workspaces.take();
  double tolerance = problem.tolerance(config.tolerance);
  if (task == 0)
    start_mean(height_m, *work);
  else
    tolerance = start_residual(task - 1, *work);
  reports[static_cast<std::size_t>(task)] =
      work->solver.solve(problem.matrix(), work->b, tolerance, config.max_iterations, work->x);
  keep(task, *work);
  workspaces.give(std::move(work));
}

/// The mean and the fields are independent; the pushes need both.
void ConditionalReconstructor::Solver::run(const FrameData& data, const LawMap& law, Executor& executor,
                                           Reconstruction& out) {
  prepare_fields(law);
  const auto solves = [&](int begin, int end) {
    for (int task = begin; task < end; ++task) solve(task, data.height_m);
  };
  for_rows(executor, fields() + 1, solves);
  if (!data.ceiling_m.empty()) {
    set_ceilings(data, law);
    const auto all_pushes = [&](int begin, int end) {
      for (int k = begin; k < end; ++k) push(k);
    };
    for_rows(executor, fields(), all_pushes);
  }
  write(executor, out);
  if (config.standard_deviation) write_sd(data, law, executor, out);
  if (!data.ceiling_m.empty()) write_pushes(data, executor, out);
}

void ConditionalReconstructor::Solver::write_sd(const FrameData& data, const LawMap& law, Executor& executor,
                                                Reconstruction& out) {
  measured_variance = data.variance_m2;
  for (std::size_t i = 0; i < measured_variance.size(); ++i)
    if (!std::isfinite(data.height_m[i])) measured_variance[i] = std::numeric_limits<float>::quiet_NaN();
  sd_map.estimate(out.mean_square_m2, fields(), measured_variance, law, config.cell_m, executor, out.sd_m);
}

}  // namespace scree::fractal
