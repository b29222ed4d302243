// Every method on the same surfaces.

#include <array>

#include "fractal/reconstruction/barycentre.hpp"
#include "fractal/reconstruction/polyhedron.hpp"
#include "fractal/reconstruction/spline.hpp"
#include "fractal/reconstruction/szeliski.hpp"
#include "fractal/reconstruction/yokoya.hpp"
#include "tests/bench/reconstruction/method_scores.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};

/// `call(request)` with `draws` draws, timed; `surfaces` that it makes in all.
template <class Call>
MethodResult timed_method(const SparseScene& scene, std::uint64_t seed, double surfaces, const Call& call) {
  MethodResult result;
  result.surfaces = surfaces;
  SurfaceRequest request = request_for(scene, 1);
  request.seed = seed;
  request.on_draw = [&](int, const Grid<float>& draw_m) { result.draw_m = draw_m; };
  const double before = thread_ms();
  result.estimate = *call(request);
  result.ms = thread_ms() - before;
  return result;
}

HeightSamples points_of(const SparseScene& scene) {
  HeightSamples samples;
  for (int r = 0; r < scene.height.rows(); ++r)
    for (int c = 0; c < scene.height.columns(); ++c) {
      if (std::isnan(scene.height(r, c))) continue;
      samples.x_m.push_back((c + 0.5) * kSceneCellM);
      samples.y_m.push_back((r + 0.5) * kSceneCellM);
      samples.z_m.push_back(static_cast<double>(scene.height(r, c)));
      samples.variance_m2.push_back(scene.sigma * scene.sigma);
    }
  return samples;
}

/// The same ground measured in every 4th row and column, without noise.
SparseScene on_lattice(SparseScene scene) {
  for (int r = 0; r < scene.truth.rows(); ++r)
    for (int c = 0; c < scene.truth.columns(); ++c) {
      const bool chosen = r % 4 == 0 && c % 4 == 0;
      scene.height(r, c) = chosen ? scene.truth(r, c) : NAN;
      scene.variance(r, c) = chosen ? static_cast<float>(scene.sigma * scene.sigma) : NAN;
    }
  return scene;
}

Method szeliski(const std::string& name, const Temperature& temperature, double surfaces) {
  return {name, kEightDraws, [=](const SparseScene& scene, std::uint64_t seed) {
            return timed_method(scene, seed, surfaces, [&](const SurfaceRequest& request) {
              SerialExecutor serial;
              return reconstruct_szeliski(cells_of(scene), request, {temperature, 50, false}, serial);
            });
          }};
}

using OnCells = Result<SurfaceEstimate> (*)(const CellSamples&, const SurfaceRequest&, Executor&);
Method on_cells(const std::string& name, OnCells method, double surfaces) {
  return {name, kEightDraws, [=](const SparseScene& scene, std::uint64_t seed) {
            return timed_method(scene, seed, surfaces, [&](const SurfaceRequest& request) {
              SerialExecutor serial;
              return method(cells_of(scene), request, serial);
            });
          }};
}

using OnPoints = Result<SurfaceEstimate> (*)(const HeightSamples&, const SurfaceRequest&, Executor&);
Method on_points(const std::string& name, OnPoints method) {
  // mean and sd are both of 8 realisations: the interval of another one
  return {name, 1.8946 * std::sqrt(1.125) / kNormal95, [=](const SparseScene& scene, std::uint64_t seed) {
            return timed_method(scene, seed, 8.0, [&](const SurfaceRequest& request) {
              SerialExecutor serial;
              return method(points_of(scene), request, serial);
            });
          }};
}

std::vector<Method> all_methods() {
  return {{"`kriging`, exact", 1.0, run_kriging},
          {"`conditional`", 1.0, run_conditional},
          szeliski("`szeliski`, closed form, 50 sweeps", {}, 9.0),
          szeliski("`szeliski`, T = 0", {Temperature::Kind::fixed, 0.0}, 1.0),
          on_cells("`thin-plate`", reconstruct_thin_plate, 1.0),
          on_cells("`membrane`", reconstruct_membrane, 1.0),
          on_points("`polyhedron`", reconstruct_polyhedron),
          on_points("`barycentre`", reconstruct_barycentre),
          on_points("`barycentre`, corrected",
                    [](const HeightSamples& samples, const SurfaceRequest& request, Executor& executor) {
                      return reconstruct_barycentre(samples, request, corrected_barycentre(), executor);
                    }),
          {"`yokoya` (every 4th row and column)", kEightDraws, [](const SparseScene& scene, std::uint64_t seed) {
             return on_cells("", reconstruct_yokoya, 9.0).run(scene, seed);
           }}};
}

using Row = std::array<MethodScore, kDimensions.size()>;

std::vector<Row> judge_all(const std::vector<Method>& methods, int count) {
  std::vector<Row> rows(methods.size());
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const std::vector<MethodScore>& scores : over_surfaces(count, [&](int i) {
           const auto seed = static_cast<std::uint64_t>(i);
           const SparseScene scene(kDimensions[d], kMethodSide, kMethodSide, 0.05, seed), lattice = on_lattice(scene);
           std::vector<MethodScore> one(methods.size());
           for (std::size_t m = 0; m < methods.size(); ++m) {
             const SparseScene& ground = methods[m].name.starts_with("`yokoya") ? lattice : scene;
             one[m].add(ground, methods[m].run(ground, seed + 1), methods[m].widening);
           }
           return one;
         }))
      for (std::size_t m = 0; m < methods.size(); ++m) rows[m][d] += scores[m];
  return rows;
}

}  // namespace

void methods_section() {
  const int count = surfaces(6);
  print_text(fmt::format(R"(
## Methods on the same ground

256 × 256 cells of exact surfaces, 5 % of them measured at random with a noise variance of 1e-3 of the squared change
over one cell, {} surfaces a D; `yokoya` has every 4th row and column of the same ground (6.25 %). The inner 224 × 224
cells are judged, those without a datum; errors in units of the change over one cell. D^ is Yokoya's over lags 1 … 16,
the slope that of rms increments over lags 1–2. Spreads of the papers' methods are those of their own 8 realisations,
with Student's quantile; a method without a spread has its mean absolute error as CRPS. Kriging's sd in 2 % of the
cells. Times: CPU, one core, of one mean or draw; kriging: half of factor, mean and draw;
conditional: a ninth of mean, 8 residual fields from scratch and the sd map.)",
                         count));
  const std::vector<Method> methods = all_methods();
  const std::vector<Row> rows = judge_all(methods, count);
  const auto table = [&](const std::string& name, const auto& cell) {
    print_text("");
    print_head(name, kDimensions);
    for (std::size_t m = 0; m < methods.size(); ++m)
      print_row(methods[m].name, kDimensions.size(), [&](std::size_t c) { return cell(rows[m][c]); });
  };
  table("D^ of a draw − D*", [](const MethodScore& s) { return with_sign(s.roughness.mean(), 3); });
  table("slope over lags 1–2, draw − truth", [](const MethodScore& s) { return with_sign(s.slope.mean(), 3); });
  table("RMSE of the mean", [](const MethodScore& s) { return fixed(s.rmse(), 3); });
  table("RMSE of a draw", [](const MethodScore& s) { return fixed(s.draw_rmse(), 3); });
  table("CRPS", [](const MethodScore& s) { return fixed(s.crps(), 3); });
  table("90 % interval covers",
        [](const MethodScore& s) { return s.score.cells > 0.0 ? fixed(s.score.coverage(), 3) : std::string("–"); });
  table("ms a mean or draw", [count](const MethodScore& s) { return fixed(s.ms / count, 2); });
}

}  // namespace scree::bench
