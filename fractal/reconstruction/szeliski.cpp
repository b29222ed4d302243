#include "fractal/reconstruction/szeliski.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "fractal/reconstruction/draw_spread.hpp"
#include "fractal/reconstruction/gibbs_rows.hpp"
#include "fractal/reconstruction/relative_pyramid.hpp"
#include "fractal/reconstruction/surface_checks.hpp"

namespace scree::fractal {
namespace {

constexpr double kLeastTemperature = 1e-6;                // beyond, float sweeps see either the prior or the data alone
constexpr std::uint64_t kGibbsSeed = 0x737a656c69736b69;  // "szeliski"

struct Run {
  SzeliskiOptions options;
  std::uint64_t seed = 1;
  int draw = -1;  ///< < 0: relaxation without noise

  SweepNoise noise(std::size_t level, int sweep) const {
    return {seed ^ kGibbsSeed, (static_cast<std::uint64_t>(draw) << 32) | (static_cast<std::uint64_t>(level) << 26) |
                                   static_cast<std::uint64_t>(sweep)};
  }
};

/// v of one level after all sweeps, from 0.
Grid<float> run_level(const GibbsLevel& problem, const Run& run, std::size_t level) {
  Grid<float> v(problem.rows(), problem.columns(), 0.0F);
  const auto sweeps = [&](const auto& sweep_once) {
    for (int sweep = 0; sweep < run.options.sweeps; ++sweep) {
      const SweepNoise noise = run.noise(level, sweep);
      sweep_once(run.draw < 0 ? nullptr : &noise);
    }
  };
  if (!run.options.tuned) {
    sweeps([&](const SweepNoise* noise) { gibbs_sweep(problem, noise, v); });
    return v;
  }
  GibbsRows rows(problem);
  PhaseField phases;
  phases.load(v);
  sweeps([&](const SweepNoise* noise) { rows.sweep(noise, phases); });
  phases.store(v);
  return v;
}

/// One surface from the coarsest level to the finest.
Grid<float> run_levels(const RelativePyramid& pyramid, const Run& run) {
  Grid<float> above;
  for (std::size_t l = pyramid.levels.size(); l-- > 0;) {
    const RelativePyramid::Level& level = pyramid.levels[l];
    Grid<float> base(level.datum.rows(), level.datum.columns(), 0.0F);
    if (!above.empty()) interpolate(above, base);
    GibbsLevel problem = level.gibbs;
    problem.right = base;
    for (std::size_t i = 0; i < base.size(); ++i) problem.right[i] = problem.precision[i] * (level.datum[i] - base[i]);
    const Grid<float> v = run_level(problem, run, l);
    for (std::size_t i = 0; i < base.size(); ++i) base[i] += v[i];
    above = std::move(base);
  }
  return above;
}

void to_metres(const RelativePyramid& pyramid, const Grid<float>& u, Grid<float>& out_m) {
  for (std::size_t i = 0; i < u.size(); ++i)
    out_m[i] = static_cast<float>(pyramid.offset_m + pyramid.unit_m * static_cast<double>(u[i]));
}

}  // namespace

Result<SurfaceEstimate> reconstruct_szeliski(const CellSamples& samples, const SurfaceRequest& request,
                                             const SzeliskiOptions& options, Executor& executor) {
  constexpr int kMaxSweeps = 1 << 26;
  if (Status status = check_surface("szeliski", samples, request); !status) return status.error();
  if (Status status = check_one_law("szeliski", request.law); !status) return status.error();
  if (options.sweeps < 1 || options.sweeps >= kMaxSweeps)
    return Error{ErrorKind::usage,
                 fmt::format("szeliski: expected 1 to {} sweeps, found {}", kMaxSweeps - 1, options.sweeps)};
  const FractalLaw& law = request.law.law;
  const double temperature = relative_temperature(options.temperature, law, request.grid.cell_m);
  const bool cold = temperature <= 0.0;
  if (!cold && !(temperature >= kLeastTemperature && temperature <= 1.0 / kLeastTemperature))
    return Error{ErrorKind::usage,
                 fmt::format("szeliski: expected a temperature of 0 or from {:g} to {:g} times the squared change over "
                             "one cell, found {:g} times",
                             kLeastTemperature, 1.0 / kLeastTemperature, temperature)};
  // Relaxation needs the balance of prior and data, though not its noise: that of the closed form.
  const RelativePyramid pyramid = make_pyramid(samples, law, request.grid.cell_m,
                                               cold ? relative_temperature({}, law, request.grid.cell_m) : temperature);
  SurfaceEstimate estimate;
  estimate.mean_m.assign(request.grid.rows, request.grid.columns, 0.0F);
  to_metres(pyramid, run_levels(pyramid, {options, request.seed, -1}), estimate.mean_m);
  estimate.iterations = options.sweeps * static_cast<int>(pyramid.levels.size());
  if (cold) {
    estimate.sd_m.assign(request.grid.rows, request.grid.columns, std::numeric_limits<float>::quiet_NaN());
    for (int k = 0; k < request.draws && request.on_draw; ++k) request.on_draw(k, estimate.mean_m);
    if (request.on_progress) request.on_progress(1.0);
    return estimate;
  }
  estimate.sd_m = spread_of_draws(
      request, estimate.mean_m,
      [&](int k, Grid<float>& draw_m) {
        to_metres(pyramid, run_levels(pyramid, {options, request.seed, k}), draw_m);
      },
      executor);
  return estimate;
}

}  // namespace scree::fractal
