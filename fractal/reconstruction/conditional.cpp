#include "fractal/reconstruction/conditional.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "fractal/fourier.hpp"
#include "fractal/reconstruction/blend_solver.hpp"
#include "fractal/reconstruction/residual_tile.hpp"

namespace scree::fractal {
namespace {

constexpr double kMaxPrecision = 1e6;  // float solves keep six digits

/// A solution in metres and where it lies on the lattice.
struct Kept {
  CellIndex min;
  PaddedField values;
  bool valid = false;

  bool overlaps(CellIndex other, int rows, int columns) const {
    return valid && other.x < min.x + values.columns() && min.x < other.x + columns &&
           other.y < min.y + values.rows() && min.y < other.y + rows;
  }
  /// Row `r` of a window at `to`, new cells from the nearest old one.
  void shifted_row(CellIndex to, int r, int columns, float* out) const {
    const float* row = values.row(std::clamp(to.y + r - min.y, 0, values.rows() - 1));
    for (int c = 0; c < columns; ++c) out[c] = row[std::clamp(to.x + c - min.x, 0, values.columns() - 1)];
  }
};

struct Problem {
  double dimension = 2.5;
  double unit_m = 1.0;      // rms change over one cell
  double weighted_m = 0.0;  // mean height of the data
  double measured = 0.0;    // cells
};

}  // namespace

struct ConditionalReconstructor::Solver {
  struct Side {  // the mean or the residual
    PaddedField x, b;
    BlendSolver solver;
    int iterations = 0;
    bool converged = false;
  };

  explicit Solver(const ReconstructionConfig& c)
      : config(c), tiles(c.seed, smooth_even_size(std::max(64, c.max_cells + c.max_cells / 2))) {}

  ReconstructionConfig config;
  ResidualTiles tiles;
  BlendOperator matrix;
  MultigridShape shape{4, 4};
  CellIndex min;
  PaddedField precision, surface;
  Side mean, residual;
  Kept kept_mean, kept_residual;

  void solve(Side& side, double tolerance) const {
    const SolveReport report = side.solver.solve(matrix, side.b, tolerance, config.max_iterations, side.x);
    side.iterations = report.iterations;
    side.converged = report.converged;
  }
  Problem load(const Grid<float>& height_m, const Grid<float>& variance_m2, const FractalLaw& law);
  void prepare_mean(const Problem& problem, const Grid<float>& height_m);
  void prepare_residual(const Problem& problem);
  void keep(const Problem& problem);
  void write(const LatticeWindow& window, Reconstruction& out) const;
};

/// Sets the precisions c; the number of measured cells may be 0.
Problem ConditionalReconstructor::Solver::load(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                               const FractalLaw& law) {
  shape = MultigridShape(height_m.rows(), height_m.columns());
  for (PaddedField* field : {&precision, &surface, &mean.x, &mean.b, &residual.x, &residual.b})
    if (field->rows() != shape.rows || field->columns() != shape.columns) field->resize(shape.rows, shape.columns);
  Problem problem;
  problem.dimension = std::clamp(law.dimension, 2.05, 2.95);
  problem.unit_m = std::max(law.rms_change_m(config.cell_m), 1e-9);
  const double unit2 = problem.unit_m * problem.unit_m;
  double weight = 0.0, sum = 0.0;
  for (int r = 0; r < shape.rows; ++r) {
    float* c = precision.row(r);
    std::fill_n(c, shape.columns, 0.0F);
    for (int i = 0; r < height_m.rows() && i < height_m.columns(); ++i) {
      if (!std::isfinite(height_m(r, i))) continue;
      const double value = std::min(kMaxPrecision, unit2 / std::max(0.0, static_cast<double>(variance_m2(r, i))));
      c[i] = static_cast<float>(value);
      weight += value;
      sum += value * static_cast<double>(height_m(r, i));
      problem.measured += 1.0;
    }
  }
  problem.weighted_m = weight > 0.0 ? sum / weight : 0.0;
  return problem;
}

void ConditionalReconstructor::Solver::prepare_mean(const Problem& problem, const Grid<float>& height_m) {
  const bool warm = kept_mean.overlaps(min, shape.rows, shape.columns);
  const auto scale = static_cast<float>(1.0 / problem.unit_m), offset = static_cast<float>(problem.weighted_m);
  for (int r = 0; r < shape.rows; ++r) {
    float *x = mean.x.row(r), *b = mean.b.row(r);
    const float* c = precision.row(r);
    std::fill_n(x, shape.columns, offset);
    if (warm) kept_mean.shifted_row(min, r, shape.columns, x);
    std::fill_n(b, shape.columns, 0.0F);
    for (int i = 0; i < shape.columns; ++i) {
      x[i] = scale * (x[i] - offset);
      if (c[i] > 0.0F) b[i] = c[i] * (scale * (height_m(r, i) - offset));
    }
  }
}

/// Right-hand side c·u + √c·n, first guess u − last residual: what changes from frame to frame is little.
void ConditionalReconstructor::Solver::prepare_residual(const Problem& problem) {
  const bool warm = kept_residual.overlaps(min, shape.rows, shape.columns);
  const CellIndex centre{min.x + shape.columns / 2, min.y + shape.rows / 2};
  const auto scale = static_cast<float>(1.0 / problem.unit_m);
  double weight = 0.0, sum = 0.0;
  for (int r = 0; r < shape.rows; ++r) {
    float* u = surface.row(r);
    tiles.surface_row(problem.dimension, {min.x, min.y + r}, centre, shape.columns, u);
    const float* c = precision.row(r);
    for (int i = 0; i < shape.columns; ++i) {
      weight += static_cast<double>(c[i]);
      sum += static_cast<double>(c[i]) * static_cast<double>(u[i]);
    }
  }
  const auto level = static_cast<float>(sum / weight);
  for (int r = 0; r < shape.rows; ++r) {
    float *u = surface.row(r), *x = residual.x.row(r), *b = residual.b.row(r);
    const float* c = precision.row(r);
    tiles.noise_row({min.x, min.y + r}, shape.columns, b);
    std::fill_n(x, shape.columns, 0.0F);
    if (warm) kept_residual.shifted_row(min, r, shape.columns, x);
    for (int i = 0; i < shape.columns; ++i) {
      u[i] -= level;
      b[i] = c[i] * u[i] + std::sqrt(c[i]) * b[i];
      x[i] = warm ? u[i] - scale * x[i] : 0.0F;
    }
  }
}

void ConditionalReconstructor::Solver::keep(const Problem& problem) {
  const auto unit = static_cast<float>(problem.unit_m), offset = static_cast<float>(problem.weighted_m);
  for (Kept* kept : {&kept_mean, &kept_residual}) {
    kept->min = min;
    kept->valid = true;
    if (kept->values.rows() != shape.rows || kept->values.columns() != shape.columns)
      kept->values.resize(shape.rows, shape.columns);
  }
  for (int r = 0; r < shape.rows; ++r)
    for (int i = 0; i < shape.columns; ++i) {
      kept_mean.values.row(r)[i] = offset + unit * mean.x.row(r)[i];
      kept_residual.values.row(r)[i] = unit * (surface.row(r)[i] - residual.x.row(r)[i]);
    }
}

void ConditionalReconstructor::Solver::write(const LatticeWindow& window, Reconstruction& out) const {
  for (int r = 0; r < window.rows; ++r) {
    const float *x = kept_mean.values.row(r), *e = kept_residual.values.row(r);
    for (int i = 0; i < window.columns; ++i) {
      out.mean_m(r, i) = x[i];
      out.draw_m(r, i) = x[i] + e[i];
    }
  }
  out.iterations = mean.iterations + residual.iterations;
  out.converged = mean.converged && residual.converged;
}

ConditionalReconstructor::ConditionalReconstructor(const ReconstructionConfig& config)
    : solver_(std::make_unique<Solver>(config)) {}
ConditionalReconstructor::~ConditionalReconstructor() = default;
ConditionalReconstructor::ConditionalReconstructor(ConditionalReconstructor&&) noexcept = default;
ConditionalReconstructor& ConditionalReconstructor::operator=(ConditionalReconstructor&&) noexcept = default;

void ConditionalReconstructor::reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                           const LatticeWindow& window, const FractalLaw& law, Executor& executor,
                                           Reconstruction& out) {
  assert(height_m.rows() == window.rows && height_m.columns() == window.columns);
  assert(variance_m2.rows() == window.rows && variance_m2.columns() == window.columns);
  assert(std::max(window.rows, window.columns) <= solver_->config.max_cells);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  out.mean_m.assign(window.rows, window.columns, kNaN);
  out.draw_m.assign(window.rows, window.columns, kNaN);
  out.iterations = 0;
  out.converged = false;
  Solver& work = *solver_;
  work.min = window.min;
  const Problem problem = work.load(height_m, variance_m2, law);
  if (problem.measured < 1.0) return;

  const double spacing = std::sqrt(static_cast<double>(height_m.size()) / problem.measured);
  work.matrix.set_up(work.shape, blend_weights(problem.dimension, blend_wavenumber(problem.dimension, spacing)),
                     work.precision);
  work.tiles.prepare(problem.dimension);
  work.prepare_mean(problem, height_m);
  work.prepare_residual(problem);
  const double tolerance = problem.dimension < 2.3 ? std::min(0.02, work.config.tolerance) : work.config.tolerance;
  executor.for_ranges(2, [&](int begin, int end) {
    for (int task = begin; task < end; ++task) work.solve(task == 0 ? work.mean : work.residual, tolerance);
  });
  work.keep(problem);
  work.write(window, out);
}

}  // namespace scree::fractal
