// Ways to treat a law that varies (varying_scene.hpp).

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/reconstruction/residual_fields.hpp"
#include "tests/bench/reconstruction/varying_scene.hpp"

namespace scree::bench {

using namespace fractal;

VaryingAnswer by_draws(const VaryingScene& scene, const LawMap& law, std::uint64_t seed, int fields, bool map_of_sd) {
  const int side = scene.side();
  VaryingAnswer answer;
  Grid<float> sum(side, side, 0.0F), square = sum;
  SurfaceRequest request{{side, side, 1.0}, law, map_of_sd ? 1 : fields, seed, {}, {}};
  request.on_draw = [&](int k, const Grid<float>& draw) {
    if (k < 8) answer.draws.push_back(draw);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += draw[i];
      square[i] += draw[i] * draw[i];
    }
  };
  SerialExecutor serial;
  SurfaceEstimate out = *reconstruct_conditional(scene.samples, request, {.residual_fields = fields}, serial);
  answer.mean = out.mean_m;
  answer.iterations = out.iterations;
  answer.sd = out.sd_m;
  if (map_of_sd) return answer;
  for (std::size_t i = 0; i < sum.size(); ++i) {  // about the mean, which is known
    const auto n = static_cast<float>(fields);
    const float m = out.mean_m[i], v = square[i] / n - 2.0F * m * sum[i] / n + m * m;
    answer.sd[i] = static_cast<float>(student_factor(fields)) * std::sqrt(std::max(v, 0.0F));
  }
  return answer;
}

Grid<float> mean_of(const VaryingScene& scene, const LawMap& law, double tolerance) {
  SerialExecutor serial;
  const SurfaceRequest request{{scene.side(), scene.side(), 1.0}, law, 0, 1, {}, {}};
  return reconstruct_conditional(scene.samples, request, {.residual_fields = 1, .tolerance = tolerance}, serial)
      ->mean_m;
}

VaryingAnswer by_one_operator(const VaryingScene& scene, std::uint64_t seed, int count) {
  const int side = scene.side();
  VaryingAnswer answer{Grid<float>(side, side), Grid<float>(side, side, 0.0F)};
  const MultigridShape shape(side, side);
  const double spacing = std::sqrt(side * side / static_cast<double>(scene.samples.cells));
  const double dimension = scene.law.law.dimension;
  PaddedField c, u, b, x;
  for (PaddedField* field : {&c, &u, &b, &x}) field->resize(side, side);
  double weight = 0.0, level = 0.0;
  for (int r = 0; r < side; ++r)
    for (int i = 0; i < side; ++i)
      if (!std::isnan(scene.samples.height_m(r, i))) {
        c.row(r)[i] = std::pow(scene.law.amplitude_m(r, i), 2.0F) / scene.samples.variance_m2(r, i);
        weight += static_cast<double>(c.row(r)[i]);
        level += static_cast<double>(c.row(r)[i] * scene.samples.height_m(r, i));
      }
  level /= weight;
  BlendOperator matrix;
  matrix.set_up(shape, blend_weights(dimension, blend_wavenumber(dimension, spacing)), c);
  BlendSolver solver;
  for (int r = 0; r < side; ++r)
    for (int i = 0; i < side; ++i)
      if (c.row(r)[i] > 0.0F) b.row(r)[i] = c.row(r)[i] * (scene.samples.height_m(r, i) - static_cast<float>(level));
  solver.solve(matrix, b, 0.02, 100, x);
  for (int r = 0; r < side; ++r)
    for (int i = 0; i < side; ++i) answer.mean(r, i) = x.row(r)[i] + static_cast<float>(level);
  const auto fields = varying_fields(scene.law, 3 * side, 16, {side, side, 1.0}, seed);
  const auto unit = static_cast<float>(scene.law.law.amplitude_m);
  for (int k = 0; k < count; ++k) {
    fields->make(k, u);
    double sum = 0.0;
    for (int r = 0; r < side; ++r)
      for (int i = 0; i < side; ++i) sum += static_cast<double>(c.row(r)[i] * unit * u.row(r)[i]) / weight;
    for (int r = 0; r < side; ++r)
      for (int i = 0; i < side; ++i) {
        u.row(r)[i] = unit * u.row(r)[i] - static_cast<float>(sum);
        const auto noise = static_cast<float>(random_normals(seed, 900 + static_cast<std::uint64_t>(k), i, r)[0]);
        const float precision = c.row(r)[i];
        // The residual's noise is that of the data, s: precision·s = amplitude·√precision.
        b.row(r)[i] = precision * u.row(r)[i] + scene.law.amplitude_m(r, i) * std::sqrt(precision) * noise;
        x.row(r)[i] = 0.0F;
      }
    solver.solve(matrix, b, 0.02, 100, x);
    for (int r = 0; r < side; ++r)
      for (int i = 0; i < side; ++i)
        answer.sd(r, i) += std::pow(u.row(r)[i] - x.row(r)[i], 2.0F) / static_cast<float>(count);
  }
  for (float& v : answer.sd) v = static_cast<float>(student_factor(count)) * std::sqrt(v);
  return answer;
}

LawMap one_law(const Grid<float>& truth) {
  return {{std::clamp(axis_dimension(truth), 2.05, 2.95), rms_increment(truth, 1)}, {}, {}};
}

}  // namespace scree::bench
