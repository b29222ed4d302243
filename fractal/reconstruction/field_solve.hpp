#pragma once
// A residual field of the conditional method.

#include "core/random.hpp"
#include "fractal/reconstruction/ceiling_push.hpp"
#include "fractal/reconstruction/cold_start.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/residual_fields.hpp"

namespace scree::fractal {

/// One field from nothing to residual.
struct FieldSolve {
  static constexpr std::uint64_t kNoiseStream = 0x636f6e642d6e00;  // "cond-n"

  PaddedField u, b, x, sample;
  BlendSolver solver;
  SolveReport report;
  CeilingPush push;

  void run(const Conditioning& problem, const ResidualFields& fields, int k, const SurfaceRequest& request,
           double tolerance, int max_iterations) {
    const MultigridShape& shape = problem.shape();
    for (PaddedField* field : {&u, &b}) field->resize(shape.rows, shape.columns);
    fields.make(k, u);
    for (int r = 0; r < request.grid.rows; ++r)
      for (int c = 0; c < request.grid.columns; ++c)
        if (problem.precision(r)[c] > 0.0F)
          b.row(r)[c] = static_cast<float>(random_normals(request.seed, field_stream(kNoiseStream, k), c, r)[0]);
    problem.residual_problem(u, b);
    start_from_means(u, problem.spacing_cells(), x);
    report = solver.solve(problem.matrix(), b, problem.cold_tolerance(tolerance), max_iterations, x);
  }

  /// And then below the ceilings: push.delta() is what that adds to mean + u − x.
  void push_below(const Conditioning& problem, const PaddedField& mean, const Grid<float>& ceiling,
                  const Grid<float>& change, double tolerance, int max_iterations) {
    sample = mean;
    for (int r = 0; r < sample.rows(); ++r)
      for (int c = 0; c < sample.columns(); ++c) sample.row(r)[c] += u.row(r)[c] - x.row(r)[c];
    const int before = push.iterations();
    push.apply(problem.shape(), problem.prior(), problem.precisions(), ceiling, change, problem.tolerance(tolerance),
               max_iterations, sample);
    report.iterations += push.iterations() - before;
    report.converged = report.converged && push.converged();
  }
};

}  // namespace scree::fractal
