#include "fractal/reconstruction/conditional_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fractal/reconstruction/break_inflation.hpp"
#include "fractal/reconstruction/data_gaps.hpp"
#include "fractal/reconstruction/field_solve.hpp"

namespace scree::fractal {
namespace {

constexpr double kBrokenTolerance = 0.01;  // of residuals whose prior has soft modes at breaks

}  // namespace

ConditionalRun::ConditionalRun(const CellSamples& samples, const SurfaceRequest& request,
                               const ConditionalOptions& options)
    : samples_(samples),
      request_(request),
      options_(options),
      fields_(std::max(options.residual_fields, request.draws)),
      field_tolerance_(options.break_edges ? std::min(kBrokenTolerance, options.tolerance) : options.tolerance) {}

SurfaceEstimate ConditionalRun::run(Executor& executor) {
  const auto [rows, columns] = std::pair{request_.grid.rows, request_.grid.columns};
  double unit_m = 1.0;
  {
    Conditioning problem;
    problem.load(samples_.height_m, samples_.variance_m2, request_.law, {0, 0}, request_.grid.cell_m);
    unit_m = problem.unit_m();
    solve_mean(problem);
    if (keeps_draws()) set_ceilings(problem);
    if (options_.break_edges) break_mean(problem);
    write_mean(problem);
    square_.assign(rows, columns, 0.0F);
    solve_fields(problem, executor);
  }
  for (float& v : square_) v /= static_cast<float>(fields_);
  SdMap sd;
  sd.estimate(square_, fields_, samples_.variance_m2, request_.law, request_.grid.cell_m, executor, out_.sd_m);
  const Grid<float> plain_sd_m = keeps_draws() ? out_.sd_m : Grid<float>();
  if (options_.break_edges) inflate(sd, unit_m);
  give_draws(plain_sd_m);
  if (pushes()) sums_.finish(fields_, samples_.height_m, out_.mean_m, out_.sd_m);
  progress(fields_ + 2);
  return std::move(out_);
}

void ConditionalRun::progress(int done) const {
  if (request_.on_progress) request_.on_progress(static_cast<double>(done) / (fields_ + 2));
}

void ConditionalRun::count(const SolveReport& report) {
  out_.iterations += report.iterations;
  out_.converged = out_.converged && report.converged;
}

void ConditionalRun::solve_mean(const Conditioning& problem) {
  BlendSolver solver;
  PaddedField b;
  problem.mean_problem(samples_.height_m, b);
  mean_.resize(b.rows(), b.columns());
  count(solver.solve(problem.matrix(), b, problem.tolerance(options_.tolerance), options_.max_iterations, mean_));
  progress(1);
}

/// Ceilings and changes over a cell, in the solver's units.
void ConditionalRun::set_ceilings(const Conditioning& problem) {
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  if (request_.law.varies()) {
    change_.assign(request_.grid.rows, request_.grid.columns, 1.0F);
    for (int r = 0; r < change_.rows(); ++r)
      for (int c = 0; c < change_.columns(); ++c)
        change_(r, c) = static_cast<float>(request_.law.at(r, c).rms_change_m(request_.grid.cell_m)) / unit;
  }
  if (!pushes()) return;
  sums_.resize(request_.grid.rows, request_.grid.columns);
  ceiling_ = options_.ceiling_m;
  for (std::size_t i = 0; i < ceiling_.size(); ++i)
    ceiling_[i] =
        std::isfinite(samples_.height_m[i]) ? std::numeric_limits<float>::quiet_NaN() : (ceiling_[i] - level) / unit;
}

void ConditionalRun::break_mean(Conditioning& problem) {
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  BlendFit& fit = breaks_.emplace(request_.grid.rows, request_.grid.columns);
  fit.prior() = problem.prior();
  for (int r = 0; r < mean_.rows(); ++r) std::copy_n(mean_.row(r), mean_.columns(), fit.row(r));
  for (int r = 0; r < request_.grid.rows; ++r)
    for (int c = 0; c < request_.grid.columns; ++c)
      if (problem.precision(r)[c] > 0.0F)
        fit.set_datum(r, c, (samples_.height_m(r, c) - level) / unit, problem.precision(r)[c]);
  break_edges(fit, change_);
  out_.iterations += fit.iterations();
  for (int r = 0; r < mean_.rows(); ++r) std::copy_n(fit.row(r), mean_.columns(), mean_.row(r));
  problem.set_edges(fit.prior());
}

void ConditionalRun::write_mean(const Conditioning& problem) {
  out_.mean_m.assign(request_.grid.rows, request_.grid.columns, 0.0F);
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  for (int r = 0; r < out_.mean_m.rows(); ++r)
    for (int c = 0; c < out_.mean_m.columns(); ++c) out_.mean_m(r, c) = level + unit * mean_.row(r)[c];
  if (!pushes()) mean_ = PaddedField();
}

/// A law that varies has no waves longer than its bands: H = ½ and its smaller torus do.
std::unique_ptr<ResidualFields> ConditionalRun::residual_fields_of(const Conditioning& problem) const {
  const SurfaceGrid& grid = request_.grid;
  const int gap = widest_gap_cells(samples_.height_m);
  const double hurst = request_.law.varies() ? 0.5 : 3.0 - problem.dimension();
  const int side = residual_torus_side(hurst, grid.rows, grid.columns, gap);
  return request_.law.varies() ? varying_fields(request_.law, side, gap, grid, request_.seed)
                               : one_law_fields(hurst, side, grid, request_.seed);
}

void ConditionalRun::solve_fields(const Conditioning& problem, Executor& executor) {
  const auto unconditional = residual_fields_of(problem);
  const int together = samples_.height_m.size() > kSideBySide ? 1 : kTogether;
  std::vector<FieldSolve> solves(static_cast<std::size_t>(std::min(together, fields_)));
  for (int first = 0; first < fields_; first += together) {
    const int n = std::min(together, fields_ - first);
    executor.for_ranges(n, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        FieldSolve& solve = solves[static_cast<std::size_t>(i)];
        solve.run(problem, *unconditional, first + i, request_, field_tolerance_, options_.max_iterations);
        if (pushes()) solve.push_below(problem, mean_, ceiling_, change_, field_tolerance_, options_.max_iterations);
      }
    });
    for (int i = 0; i < n; ++i) take(problem, solves[static_cast<std::size_t>(i)], first + i);
    progress(1 + first + n);
  }
}

void ConditionalRun::take(const Conditioning& problem, const FieldSolve& solve, int k) {
  count(solve.report);
  const auto unit = static_cast<float>(problem.unit_m());
  const bool draw = k < request_.draws && request_.on_draw;
  if (draw) draw_.assign(square_.rows(), square_.columns(), 0.0F);
  for (int r = 0; r < square_.rows(); ++r) {
    const float *u = solve.u.row(r), *e = solve.x.row(r);
    const float* push = pushes() ? solve.push.delta().row(r) : nullptr;
    for (int c = 0; c < square_.columns(); ++c) {
      const float residual = unit * (u[c] - e[c]), delta = push != nullptr ? unit * push[c] : 0.0F;
      square_(r, c) += residual * residual;
      if (push != nullptr) sums_.add(r, c, residual, delta);
      if (draw) draw_(r, c) = residual + delta;
    }
  }
  if (!draw) return;
  draws_.push_back(std::move(draw_));
  if (!keeps_draws()) give_draws({});
}

/// Variances beside breaks, by what data left out show.
void ConditionalRun::inflate(const SdMap& sd, double unit_m) {
  Grid<float> alone = sd.variance_alone_m2();
  for (float& v : alone) v /= static_cast<float>(unit_m * unit_m);
  const Grid<float> factor = break_inflation(*breaks_, alone, request_.law.law.hurst(), change_);
  sd.inflate(factor, samples_.variance_m2, out_.sd_m);
}

/// Hands over what is held; `plain_sd_m`: that of the residuals, empty where it is that of the map.
void ConditionalRun::give_draws(const Grid<float>& plain_sd_m) {
  for (Grid<float>& draw : draws_) {
    for (std::size_t i = 0; i < draw.size(); ++i) {
      const float grown = plain_sd_m.empty() ? 1.0F : out_.sd_m[i] / plain_sd_m[i];
      draw[i] = out_.mean_m[i] + grown * draw[i];
    }
    request_.on_draw(given_++, draw);
  }
  draws_.clear();
}

}  // namespace scree::fractal
