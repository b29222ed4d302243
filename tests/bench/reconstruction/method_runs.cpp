// The two methods that more than one section compares.

#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/reconstruction/unconditional_fields.hpp"
#include "tests/bench/reconstruction/method_scores.hpp"

namespace scree::bench {

using namespace fractal;

namespace {

struct Data {
  std::vector<CellIndex> places;
  std::vector<double> noise;
  Eigen::VectorXd heights;  // in units
};

Data data_of(const SparseScene& scene, double unit) {
  Data data;
  std::vector<double> heights;
  for (int r = 0; r < scene.height.rows(); ++r)
    for (int c = 0; c < scene.height.columns(); ++c)
      if (!std::isnan(scene.height(r, c))) {
        data.places.push_back({c, r});
        data.noise.push_back(std::pow(scene.sigma / unit, 2));
        heights.push_back(static_cast<double>(scene.height(r, c)) / unit);
      }
  data.heights = Eigen::Map<Eigen::VectorXd>(heights.data(), static_cast<Eigen::Index>(heights.size()));
  return data;
}

Grid<float> some_deviations(const SparseScene& scene, const IntrinsicKriging& kriging, double unit,
                            std::uint64_t seed) {
  std::vector<CellIndex> cells;
  for (int r = kMethodMargin; r < scene.height.rows() - kMethodMargin; ++r)
    for (int c = kMethodMargin; c < scene.height.columns() - kMethodMargin; ++c)
      if (std::isnan(scene.height(r, c)) && to_uniform(random_words(seed, 31, c, r)[0]) < 0.02) cells.push_back({c, r});
  std::vector<double> sd(cells.size());
  kriging.deviations(cells, sd.data());
  Grid<float> out(scene.height.rows(), scene.height.columns(), NAN);
  for (std::size_t i = 0; i < cells.size(); ++i) out(cells[i].y, cells[i].x) = static_cast<float>(unit * sd[i]);
  return out;
}

}  // namespace

MethodResult run_kriging(const SparseScene& scene, std::uint64_t seed) {
  const int rows = scene.height.rows(), columns = scene.height.columns();
  const double unit = scene.law.rms_change_m(kSceneCellM), before = thread_ms();
  const Data data = data_of(scene, unit);
  const IntrinsicKriging kriging = *IntrinsicKriging::make(scene.law.hurst(), rows, columns, data.places, data.noise);
  const Grid<float> u = UnconditionalFields::make(scene.law.hurst(), rows, columns)->field(seed, 0);
  Eigen::MatrixXd sets(data.heights.size(), 2);
  sets.col(0) = data.heights;
  for (Eigen::Index i = 0; i < sets.rows(); ++i) {
    const CellIndex place = data.places[static_cast<std::size_t>(i)];
    const double noise = scene.sigma / unit * random_normals(seed, 32, place.x, place.y)[0];
    sets(i, 1) = data.heights(i) - static_cast<double>(u(place.y, place.x)) - noise;
  }
  const IntrinsicKriging::Weights weights = kriging.weights_of(sets);
  MethodResult result;
  result.estimate.mean_m.assign(rows, columns, 0.0F);
  result.draw_m.assign(rows, columns, 0.0F);
  std::vector<double> line(static_cast<std::size_t>(columns));
  for (int set = 0; set < 2; ++set)
    for (int r = 0; r < rows; ++r) {
      kriging.mean_row(weights, set, r, line.data());
      for (int c = 0; c < columns; ++c) {
        const double value = line[static_cast<std::size_t>(c)] + (set == 0 ? 0.0 : static_cast<double>(u(r, c)));
        (set == 0 ? result.estimate.mean_m : result.draw_m)(r, c) = static_cast<float>(unit * value);
      }
    }
  result.ms = thread_ms() - before;
  result.surfaces = 2.0;
  result.estimate.sd_m = some_deviations(scene, kriging, unit, seed);
  return result;
}

MethodResult run_conditional(const SparseScene& scene, std::uint64_t seed) {
  const ConditionalOptions options;
  SerialExecutor serial;
  MethodResult result;
  SurfaceRequest request = request_for(scene, 1);
  request.seed = seed;
  request.on_draw = [&](int, const Grid<float>& draw_m) { result.draw_m = draw_m; };
  const CellSamples samples = cells_of(scene);
  const double before = thread_ms();
  result.estimate = *reconstruct_conditional(samples, request, options, serial);
  result.ms = thread_ms() - before;
  result.surfaces = 1.0 + options.residual_fields;
  return result;
}

}  // namespace scree::bench
