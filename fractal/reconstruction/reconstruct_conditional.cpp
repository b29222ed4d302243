#include "fractal/reconstruction/reconstruct_conditional.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>

#include "core/random.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/data_gaps.hpp"
#include "fractal/reconstruction/distance_transform.hpp"
#include "fractal/reconstruction/sd_map.hpp"
#include "fractal/reconstruction/surface_checks.hpp"
#include "fractal/reconstruction/residual_fields.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kNoiseStream = 0x636f6e642d6e00;   // "cond-n", field k in the last byte and beyond
constexpr std::size_t kSideBySide = std::size_t{1} << 20;  // cells: up to here several fields are solved for at once
constexpr int kTogether = 4;

Status check(const CellSamples& samples, const SurfaceRequest& request, const ConditionalOptions& options) {
  if (Status status = check_surface("conditional", samples, request); !status) return status;
  const SurfaceGrid& grid = request.grid;
  if (options.residual_fields < 1)
    return Error{ErrorKind::usage,
                 fmt::format("conditional: expected at least 1 residual field, found {}", options.residual_fields)};
  if (std::max(grid.rows, grid.columns) > DistanceTransform::kMaxSide)
    return Error{ErrorKind::usage, fmt::format("conditional: expected at most {} cells a side, found {} x {}",
                                               DistanceTransform::kMaxSide, grid.rows, grid.columns)};
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

/// One field from nothing to residual.
struct FieldSolve {
  PaddedField u, b, x;
  BlendSolver solver;
  SolveReport report;

  void run(const Conditioning& problem, const ResidualFields& fields, int k, const SurfaceRequest& request,
           const ConditionalOptions& options) {
    const MultigridShape& shape = problem.shape();
    for (PaddedField* field : {&u, &b, &x}) field->resize(shape.rows, shape.columns);
    fields.make(k, u);
    for (int r = 0; r < request.grid.rows; ++r)
      for (int c = 0; c < request.grid.columns; ++c)
        if (problem.precision(r)[c] > 0.0F)
          b.row(r)[c] =
              static_cast<float>(random_normals(request.seed, kNoiseStream + static_cast<std::uint64_t>(k), c, r)[0]);
    problem.residual_problem(u, b);
    report = solver.solve(problem.matrix(), b, problem.tolerance(options.tolerance), options.max_iterations, x);
  }
};

class Reconstructing {
 public:
  Reconstructing(const CellSamples& samples, const SurfaceRequest& request, const ConditionalOptions& options)
      : samples_(samples),
        request_(request),
        options_(options),
        fields_(std::max(options.residual_fields, request.draws)) {}

  SurfaceEstimate run(Executor& executor) {
    const auto [rows, columns] = std::pair{request_.grid.rows, request_.grid.columns};
    {
      Conditioning problem;
      problem.load(samples_.height_m, samples_.variance_m2, request_.law, {0, 0}, request_.grid.cell_m);
      solve_mean(problem);
      square_.assign(rows, columns, 0.0F);
      solve_fields(problem, executor);
    }
    for (float& v : square_) v /= static_cast<float>(fields_);
    SdMap sd;
    sd.estimate(square_, fields_, samples_.variance_m2, request_.law, request_.grid.cell_m, executor, out_.sd_m);
    progress(fields_ + 2);
    return std::move(out_);
  }

 private:
  void progress(int done) const {
    if (request_.on_progress) request_.on_progress(static_cast<double>(done) / (fields_ + 2));
  }
  void count(const SolveReport& report) {
    out_.iterations += report.iterations;
    out_.converged = out_.converged && report.converged;
  }

  void solve_mean(const Conditioning& problem) {
    BlendSolver solver;
    PaddedField b, x;
    problem.mean_problem(samples_.height_m, b);
    x.resize(b.rows(), b.columns());
    count(solver.solve(problem.matrix(), b, problem.tolerance(options_.tolerance), options_.max_iterations, x));
    out_.mean_m.assign(request_.grid.rows, request_.grid.columns, 0.0F);
    const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
    for (int r = 0; r < out_.mean_m.rows(); ++r)
      for (int c = 0; c < out_.mean_m.columns(); ++c) out_.mean_m(r, c) = level + unit * x.row(r)[c];
    progress(1);
  }

  /// A law that varies has no waves longer than its bands: H = ½ and its smaller torus do.
  std::unique_ptr<ResidualFields> residual_fields_of(const Conditioning& problem) const {
    const SurfaceGrid& grid = request_.grid;
    const int gap = widest_gap_cells(samples_.height_m);
    const double hurst = request_.law.varies() ? 0.5 : 3.0 - problem.dimension();
    const int side = residual_torus_side(hurst, grid.rows, grid.columns, gap);
    return request_.law.varies() ? varying_fields(request_.law, side, gap, grid, request_.seed)
                                 : one_law_fields(hurst, side, grid, request_.seed);
  }

  void solve_fields(const Conditioning& problem, Executor& executor) {
    const auto unconditional = residual_fields_of(problem);
    const int together = samples_.height_m.size() > kSideBySide ? 1 : kTogether;
    std::vector<FieldSolve> solves(static_cast<std::size_t>(std::min(together, fields_)));
    for (int first = 0; first < fields_; first += together) {
      const int n = std::min(together, fields_ - first);
      executor.for_ranges(n, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
          solves[static_cast<std::size_t>(i)].run(problem, *unconditional, first + i, request_, options_);
      });
      for (int i = 0; i < n; ++i) take(problem, solves[static_cast<std::size_t>(i)], first + i);
      progress(1 + first + n);
    }
  }

  void take(const Conditioning& problem, const FieldSolve& solve, int k) {
    count(solve.report);
    const auto unit = static_cast<float>(problem.unit_m());
    const bool draw = k < request_.draws && request_.on_draw;
    if (draw) draw_.assign(square_.rows(), square_.columns(), 0.0F);
    for (int r = 0; r < square_.rows(); ++r) {
      const float *u = solve.u.row(r), *e = solve.x.row(r);
      for (int c = 0; c < square_.columns(); ++c) {
        const float residual = unit * (u[c] - e[c]);
        square_(r, c) += residual * residual;
        if (draw) draw_(r, c) = out_.mean_m(r, c) + residual;
      }
    }
    if (draw) request_.on_draw(k, draw_);
  }

  const CellSamples& samples_;
  const SurfaceRequest& request_;
  const ConditionalOptions& options_;
  int fields_;
  Grid<float> square_, draw_;
  SurfaceEstimate out_;
};

}  // namespace

Result<SurfaceEstimate> reconstruct_conditional(const CellSamples& samples, const SurfaceRequest& request,
                                                const ConditionalOptions& options, Executor& executor) {
  if (Status status = check(samples, request, options); !status) return status.error();
  return Reconstructing(samples, request, options).run(executor);
}

std::size_t conditional_memory_bytes(int rows, int columns, bool law_varies) {
  const MultigridShape shape(rows, columns);
  const auto cells = static_cast<double>(shape.rows) * shape.columns;
  const double side = residual_torus_side(0.95, shape.rows, shape.columns, std::max(shape.rows, shape.columns) / 32);
  const double together = cells > static_cast<double>(kSideBySide) ? 1.0 : kTogether;
  const double levels = 4.0 / 3.0;
  const double held = 10.0 + 4.0 * 4.0 + (law_varies ? 8.0 : 0.0);  // samples; mean, squares, draw, sd; law
  const double matrix = 4.0 + 8.0 * levels + (law_varies ? 8.0 + 16.0 * levels : 0.0);
  const double solve = 4.0 * (3.0 + 4.0) + 4.0 * levels + 8.0 / 3.0;  // u b x, r z p q, levels
  const double synthesis = 4.0 * cells + 4.0 * side * shape.columns + 2.0 * side * side;
  const double solving = cells * (held + matrix + together * solve) + together * synthesis;
  const double deviations = cells * (held + 60.0);  // SdMap
  return static_cast<std::size_t>(std::max(solving, deviations));
}

int largest_conditional_side(std::size_t bytes, bool law_varies) {
  int side = 0;
  while (side + 64 <= DistanceTransform::kMaxSide &&
         conditional_memory_bytes(side + 64, side + 64, law_varies) <= bytes)
    side += 64;
  return side;
}

}  // namespace scree::fractal
