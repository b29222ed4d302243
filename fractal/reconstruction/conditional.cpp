#include "fractal/reconstruction/conditional.hpp"

#include <cassert>
#include <limits>

#include "fractal/reconstruction/conditional_frames.hpp"

namespace scree::fractal {

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
  reconstruct(height_m, variance_m2, Grid<float>(), window, law, executor, out);
}

void ConditionalReconstructor::reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                           const Grid<float>& ceiling_m, const LatticeWindow& window, const LawMap& law,
                                           Executor& executor, Reconstruction& out) {
  assert(height_m.rows() == window.rows && height_m.columns() == window.columns);
  assert(variance_m2.rows() == window.rows && variance_m2.columns() == window.columns);
  assert(ceiling_m.empty() || (ceiling_m.rows() == window.rows && ceiling_m.columns() == window.columns));
  assert(std::max(window.rows, window.columns) <= solver_->config.max_cells);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  Solver& work = *solver_;
  out.draws_m.resize(static_cast<std::size_t>(work.fields()));
  for (Grid<float>& draw : out.draws_m) draw.reshape(window.rows, window.columns);
  out.mean_m.reshape(window.rows, window.columns);
  for (Grid<float>* grid : {&out.free_mean_m, &out.mean_square_m2, &out.sd_m}) grid->assign(0, 0, kNaN);
  out.iterations = 0;
  out.converged = false;
  work.window = window;
  if (work.problem.load(height_m, variance_m2, law, window.min, work.config.cell_m))
    return work.run({height_m, variance_m2, ceiling_m}, law, executor, out);
  out.mean_m.assign(window.rows, window.columns, kNaN);
  for (Grid<float>& draw : out.draws_m) draw.assign(window.rows, window.columns, kNaN);
}

}  // namespace scree::fractal
