// Rays over the ground of a frame, and what leaves the reconstructor.

#include <algorithm>
#include <cmath>
#include <limits>

#include "fractal/lanes.hpp"
#include "fractal/reconstruction/conditional_frames.hpp"

namespace scree::fractal {

void ConditionalReconstructor::Solver::set_ceilings(const FrameData& data, const LawMap& law) {
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  const auto log_cell = static_cast<float>(std::log(config.cell_m));
  ceiling.assign(window.rows, window.columns, std::numeric_limits<float>::quiet_NaN());
  change.assign(varies ? window.rows : 0, varies ? window.columns : 0, 1.0F);
  for (int r = 0; r < window.rows; ++r)
    for (int c = 0; c < window.columns; ++c) {
      const float height_m = data.height_m(r, c), limit_m = data.ceiling_m(r, c);
      if (height_m - height_m == 0.0F || !(limit_m < std::numeric_limits<float>::infinity())) continue;
      ceiling(r, c) = (limit_m - level) / unit;
      if (varies) change(r, c) = law.amplitude_m(r, c) * fast_exp((3.0F - law.dimension(r, c)) * log_cell) / unit;
    }
}

void ConditionalReconstructor::Solver::push(int k) {
  const auto field = static_cast<std::size_t>(k);
  const MultigridShape& shape = problem.shape();
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  KeptSolution& last = pushes[field];
  const KeptSolution &mean = kept[0], &residual = kept[field + 1];
  std::unique_ptr<Workspace> work = workspaces.take();
  work->u.reshape(shape.rows, shape.columns);
  work->x.reshape(shape.rows, shape.columns);
  const bool warm = last.overlaps(window.min, shape.rows, shape.columns);
  for (int r = 0; r < shape.rows; ++r) {
    const float *m = mean.values.row(r), *e = residual.values.row(r);
    float *sample = work->u.row(r), *delta = work->x.row(r);
    std::fill_n(delta, shape.columns, 0.0F);
    if (warm) last.shifted_row(window.min, r, shape.columns, delta);
    for (int i = 0; i < shape.columns; ++i) {
      sample[i] = (m[i] - level + e[i]) / unit;
      delta[i] /= unit;
    }
  }
  CeilingPush& push = work->push;
  pushed[field] = push.follow(shape, problem.prior(), problem.precisions(), ceiling, change,
                              problem.tolerance(config.tolerance), config.max_iterations, work->u, work->x)
                      ? 1
                      : 0;
  SolveReport& report = reports[field + 1];
  report.iterations += push.iterations();
  report.converged = report.converged && push.converged();
  last.min = window.min;
  last.valid = true;
  last.values.reshape(shape.rows, shape.columns);
  for (int r = 0; r < shape.rows; ++r)
    for (int i = 0; i < shape.columns; ++i) last.values.row(r)[i] = unit * work->x.row(r)[i];
  workspaces.give(std::move(work));
}

void ConditionalReconstructor::Solver::write_row(int r, Reconstruction& out) const {
  const float share = 1.0F / static_cast<float>(fields());
  const float* x = kept[0].values.row(r);
  std::copy_n(x, window.columns, out.mean_m.row(r).data());
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const float* residual = kept[k].values.row(r);
    float* draw = out.draws_m[k - 1].row(r).data();
    for (int i = 0; i < window.columns; ++i) draw[i] = x[i] + residual[i];
    if (out.mean_square_m2.empty()) continue;
    float* square = out.mean_square_m2.row(r).data();
    for (int i = 0; i < window.columns; ++i) square[i] += share * residual[i] * residual[i];
  }
}

void ConditionalReconstructor::Solver::write(Executor& executor, Reconstruction& out) const {
  if (fields() > 1 || config.standard_deviation) out.mean_square_m2.assign(window.rows, window.columns, 0.0F);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) write_row(r, out);
  });
  out.converged = true;
  for (const SolveReport& report : reports) {
    out.iterations += report.iterations;
    out.converged = out.converged && report.converged;
  }
}

/// The pushes move draws, mean and standard deviation.
void ConditionalReconstructor::Solver::write_pushes(const FrameData& data, Executor& executor, Reconstruction& out) {
  out.free_mean_m = out.mean_m;
  if (std::find(pushed.begin(), pushed.end(), 1) == pushed.end()) return;
  sums.resize(window.rows, window.columns);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (std::size_t k = 0; k < pushes.size(); ++k)
      for (int r = begin; r < end; ++r) {
        const float *residual = kept[k + 1].values.row(r), *delta = pushes[k].values.row(r);
        float* draw = out.draws_m[k].row(r).data();
        for (int c = 0; c < window.columns; ++c) draw[c] += delta[c];
        sums.add_row(r, residual, delta);
      }
  });
  if (!out.sd_m.empty()) return sums.finish(fields(), data.height_m, out.mean_m, out.sd_m);
  sums.move_mean(fields(), out.mean_m);
}

}  // namespace scree::fractal
