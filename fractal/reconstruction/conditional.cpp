#include "fractal/reconstruction/conditional.hpp"

#include <cassert>
#include <limits>
#include <vector>

#include "fractal/fourier.hpp"
#include "fractal/reconstruction/band_tiles.hpp"
#include "fractal/reconstruction/cold_start.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/kept_solution.hpp"
#include "fractal/reconstruction/residual_tile.hpp"
#include "fractal/reconstruction/workspaces.hpp"

namespace scree::fractal {
struct ConditionalReconstructor::Solver {
  explicit Solver(const ReconstructionConfig& c)
      : config(c),
        tiles(c.seed, smooth_even_size(std::max(64, c.max_cells + c.max_cells / 2))),
        kept(static_cast<std::size_t>(std::max(1, c.residual_fields)) + 1),
        reports(kept.size()) {}

  ReconstructionConfig config;
  ResidualTiles tiles;
  std::unique_ptr<BandTiles> bands;
  BandAmplitudes amplitudes;
  bool varies = false;
  Conditioning problem;
  CellIndex min;
  Workspaces workspaces;
  std::vector<KeptSolution> kept;  // mean, residual 0, 1, …
  std::vector<SolveReport> reports;

  int fields() const { return static_cast<int>(kept.size()) - 1; }
  void prepare_fields(const LawMap& law, const LatticeWindow& window);
  void start_mean(const Grid<float>& height_m, Workspace& work) const;
  double start_residual(int k, const LatticeWindow& window, Workspace& work) const;
  void keep(int task, const Workspace& work);
  void solve(int task, const Grid<float>& height_m, const LatticeWindow& window);
  void write(const LatticeWindow& window, Reconstruction& out) const;
};

void ConditionalReconstructor::Solver::prepare_fields(const LawMap& law, const LatticeWindow& window) {
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
  if (!kept.front().overlaps(min, shape.rows, shape.columns)) return work.x.resize(shape.rows, shape.columns);
  work.x.reshape(shape.rows, shape.columns);
  for (int r = 0; r < shape.rows; ++r) {
    float* x = work.x.row(r);
    kept.front().shifted_row(min, r, shape.columns, x);
    for (int i = 0; i < shape.columns; ++i) x[i] = scale * (x[i] - level);
  }
}

/// First guess u − last residual: what changes from frame to frame is little. In the margin u is a copy of the border.
/// Returns the tolerance of the solve.
double ConditionalReconstructor::Solver::start_residual(int k, const LatticeWindow& window, Workspace& work) const {
  const MultigridShape& shape = problem.shape();
  const CellIndex centre{min.x + shape.columns / 2, min.y + shape.rows / 2};
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
  if (!last.overlaps(min, shape.rows, shape.columns)) {
    start_from_means(work.u, problem.spacing_cells(), work.x);
    return problem.cold_tolerance(config.tolerance);
  }
  work.x.reshape(shape.rows, shape.columns);
  const auto scale = static_cast<float>(1.0 / problem.unit_m());
  for (int r = 0; r < shape.rows; ++r) {
    float* x = work.x.row(r);
    const float* u = work.u.row(r);
    last.shifted_row(min, r, shape.columns, x);
    for (int i = 0; i < shape.columns; ++i) x[i] = u[i] - scale * x[i];
  }
  return problem.tolerance(config.tolerance);
}

void ConditionalReconstructor::Solver::keep(int task, const Workspace& work) {
  KeptSolution& solution = kept[static_cast<std::size_t>(task)];
  const MultigridShape& shape = problem.shape();
  const auto unit = static_cast<float>(problem.unit_m()), level = static_cast<float>(problem.level_m());
  solution.min = min;
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

void ConditionalReconstructor::Solver::solve(int task, const Grid<float>& height_m, const LatticeWindow& window) {
  std::unique_ptr<Workspace> work = workspaces.take();
  double tolerance = problem.tolerance(config.tolerance);
  if (task == 0)
    start_mean(height_m, *work);
  else
    tolerance = start_residual(task - 1, window, *work);
  reports[static_cast<std::size_t>(task)] =
      work->solver.solve(problem.matrix(), work->b, tolerance, config.max_iterations, work->x);
  keep(task, *work);
  workspaces.give(std::move(work));
}

void ConditionalReconstructor::Solver::write(const LatticeWindow& window, Reconstruction& out) const {
  const float share = 1.0F / static_cast<float>(fields());
  if (fields() > 1) out.mean_square_m2.assign(window.rows, window.columns, 0.0F);
  for (int r = 0; r < window.rows; ++r) {
    const float *x = kept[0].values.row(r), *e = kept[1].values.row(r);
    float *mean = out.mean_m.row(r).data(), *draw = out.draw_m.row(r).data();
    for (int i = 0; i < window.columns; ++i) {
      mean[i] = x[i];
      draw[i] = x[i] + e[i];
    }
    if (fields() == 1) continue;
    float* square = out.mean_square_m2.row(r).data();
    for (std::size_t k = 1; k < kept.size(); ++k) {
      const float* residual = kept[k].values.row(r);
      for (int i = 0; i < window.columns; ++i) square[i] += share * residual[i] * residual[i];
    }
  }
  out.converged = true;
  for (const SolveReport& report : reports) {
    out.iterations += report.iterations;
    out.converged = out.converged && report.converged;
  }
}

ConditionalReconstructor::ConditionalReconstructor(const ReconstructionConfig& config)
    : solver_(std::make_unique<Solver>(config)) {}
ConditionalReconstructor::~ConditionalReconstructor() = default;
ConditionalReconstructor::ConditionalReconstructor(ConditionalReconstructor&&) noexcept = default;
ConditionalReconstructor& ConditionalReconstructor::operator=(ConditionalReconstructor&&) noexcept = default;

void ConditionalReconstructor::reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                           const LatticeWindow& window, const FractalLaw& law, Executor& executor,
                                           Reconstruction& out) {
  reconstruct(height_m, variance_m2, window, LawMap{law, {}, {}}, executor, out);
}

void ConditionalReconstructor::reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                           const LatticeWindow& window, const LawMap& law, Executor& executor,
                                           Reconstruction& out) {
  assert(height_m.rows() == window.rows && height_m.columns() == window.columns);
  assert(variance_m2.rows() == window.rows && variance_m2.columns() == window.columns);
  assert(std::max(window.rows, window.columns) <= solver_->config.max_cells);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  out.mean_m.assign(window.rows, window.columns, kNaN);
  out.draw_m.assign(window.rows, window.columns, kNaN);
  out.mean_square_m2.assign(0, 0, kNaN);
  out.iterations = 0;
  out.converged = false;
  Solver& work = *solver_;
  work.min = window.min;
  if (!work.problem.load(height_m, variance_m2, law, window.min, work.config.cell_m)) return;
  work.prepare_fields(law, window);
  executor.for_ranges(work.fields() + 1, [&](int begin, int end) {
    for (int task = begin; task < end; ++task) work.solve(task, height_m, window);
  });
  work.write(window, out);
}

}  // namespace scree::fractal
