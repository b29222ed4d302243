#include "fractal/reconstruction/spline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fractal/reconstruction/blend_solver.hpp"
#include "fractal/reconstruction/surface_checks.hpp"

namespace scree::fractal {
namespace {

constexpr double kMaxPrecision = 1e6;  // float solves keep six digits
constexpr int kMaxCycles = 300;

enum class Order : std::uint8_t { membrane, thin_plate };

/// All of the blend's weight at its wavenumber on one of the two orders.
BlendWeights weights_of(Order order, double dimension, double spacing_cells) {
  const double k0 = blend_wavenumber(dimension, spacing_cells);
  const BlendWeights blend = blend_weights(dimension, k0);
  const double total = static_cast<double>(blend.w1) * k0 * k0 + static_cast<double>(blend.w2) * std::pow(k0, 4);
  if (order == Order::membrane) return {static_cast<float>(total / (k0 * k0)), 0.0F};
  return {0.0F, static_cast<float>(total / std::pow(k0, 4))};
}

struct Problem {
  MultigridShape shape;
  PaddedField precision, b;
  double unit_m = 1.0, offset_m = 0.0, measured = 0.0;

  Problem(const CellSamples& samples, double unit)
      : shape(samples.height_m.rows(), samples.height_m.columns()), unit_m(unit) {
    precision.resize(shape.rows, shape.columns);
    b.resize(shape.rows, shape.columns);
    double weight = 0.0, sum = 0.0;
    for_data(samples, [&](int r, int c, double height, double variance) {
      const double value = std::min(kMaxPrecision, unit_m * unit_m / variance);
      precision.row(r)[c] = static_cast<float>(value);
      weight += value, sum += value * height, measured += 1.0;
    });
    offset_m = sum / weight;
    for_data(samples, [&](int r, int c, double height, double) {
      b.row(r)[c] = precision.row(r)[c] * static_cast<float>((height - offset_m) / unit_m);
    });
  }

 private:
  template <class Body>
  static void for_data(const CellSamples& samples, const Body& body) {
    for (int r = 0; r < samples.height_m.rows(); ++r)
      for (int c = 0; c < samples.height_m.columns(); ++c)
        if (!std::isnan(samples.height_m(r, c)))
          body(r, c, static_cast<double>(samples.height_m(r, c)), static_cast<double>(samples.variance_m2(r, c)));
  }
};

Result<SurfaceEstimate> reconstruct(Order order, const CellSamples& samples, const SurfaceRequest& request) {
  const char* name = order == Order::membrane ? "membrane" : "thin-plate";
  if (Status status = check_surface(name, samples, request); !status) return status.error();
  if (Status status = check_one_law(name, request.law); !status) return status.error();
  const FractalLaw& law = request.law.law;
  const auto [rows, columns] = std::pair{request.grid.rows, request.grid.columns};
  const Problem problem(samples, law.rms_change_m(request.grid.cell_m));

  const double spacing = std::sqrt(static_cast<double>(samples.height_m.size()) / problem.measured);
  BlendOperator matrix;
  matrix.set_up(problem.shape, weights_of(order, law.dimension, spacing), problem.precision);
  BlendSolver solver;
  PaddedField x;
  x.resize(problem.shape.rows, problem.shape.columns);
  const SolveReport report = solver.solve(matrix, problem.b, 1e-4, kMaxCycles, x);

  SurfaceEstimate estimate;
  estimate.iterations = report.iterations;
  estimate.converged = report.converged;
  estimate.sd_m.assign(rows, columns, std::numeric_limits<float>::quiet_NaN());
  estimate.mean_m.assign(rows, columns, 0.0F);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      estimate.mean_m(r, c) = static_cast<float>(problem.offset_m + problem.unit_m * static_cast<double>(x.row(r)[c]));
  for (int k = 0; k < request.draws && request.on_draw; ++k) request.on_draw(k, estimate.mean_m);
  if (request.on_progress) request.on_progress(1.0);
  return estimate;
}

}  // namespace

Result<SurfaceEstimate> reconstruct_membrane(const CellSamples& samples, const SurfaceRequest& request, Executor&) {
  return reconstruct(Order::membrane, samples, request);
}

Result<SurfaceEstimate> reconstruct_thin_plate(const CellSamples& samples, const SurfaceRequest& request, Executor&) {
  return reconstruct(Order::thin_plate, samples, request);
}

}  // namespace scree::fractal
