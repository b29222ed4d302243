// The mapper on one core: whole steps for the frame sizes that must keep up (256 x 256 at 20 frames/s, 640 x 480 at
// 5 frames/s), and its stages alone. A robot drives 0.1 m a frame over an fBm surface (D = 2.3, 0.1 m at 1 m).

#include <array>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "mapping/mapper.hpp"

namespace scree::mapping {
namespace {

constexpr double kGroundCell_m = 0.05;
constexpr int kGroundCells = 700;

const Grid<float>& ground() {
  static const Grid<float> heights = *fractal::fbm_surface({2.3, 0.1}, kGroundCells, kGroundCells, kGroundCell_m, 1);
  return heights;
}

double ground_m(double x_m, double y_m) {
  const auto cell = [](double v) {
    const int i = static_cast<int>(std::floor(v / kGroundCell_m)) + kGroundCells / 2;
    return i < 0 ? 0 : (i >= kGroundCells ? kGroundCells - 1 : i);
  };
  return static_cast<double>(ground()(cell(y_m), cell(x_m)));
}

double first_hit_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const auto below = [&](double t) {
    const Eigen::Vector3d p = origin + t * ray;
    return p.z() < ground_m(p.x(), p.y());
  };
  double t = 0.5;
  while (t < 39.0 && !below(t)) t += 0.05;
  double near = t - 0.05, far = t;
  for (int i = 0; i < 12; ++i) (below(0.5 * (near + far)) ? far : near) = 0.5 * (near + far);
  return far;
}

/// 60° x 60° spherical scanner, 1.6 m up, tilted 25° down, 2 cm noise; or, of 64 rows, one that looks all around.
struct Scanner {
  Scanner(int rows, int columns) {
    const bool around = rows == 64;
    ProjectionConfig config;
    config.kind = ProjectionKind::spherical;
    config.range_per_count_m = 0.001;
    config.ambiguity_m = 0.0;
    const double high = around ? 0.03 : 0.52, low = around ? -0.43 : -0.52, side = around ? 3.14159 : 0.52;
    for (int r = 0; r < rows; ++r) config.row_elevations_rad.push_back(high + (low - high) * (r + 0.5) / rows);
    for (int c = 0; c < columns; ++c) config.column_azimuths_rad.push_back(side - 2.0 * side * (c + 0.5) / columns);
    auto made = std::make_shared<SensorConfig>();
    made->projection = config;
    made->T_body_sensor.translation_m = {0.3, 0.0, 1.6};
    if (!around) made->T_body_sensor.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.44, Eigen::Vector3d::UnitY()));
    made->filter.range_max_m = 39.0;
    sensor = made;
    projection = *make_projection(config, rows, columns);
  }

  RangeFrame frame(int number) const {
    RangeFrame out;
    out.projection = projection;
    out.sensor = sensor;
    out.sequence = static_cast<std::uint64_t>(number);
    out.range_m = Grid<float>(projection->rows, projection->columns, std::numeric_limits<float>::quiet_NaN());
    Pose body;
    body.translation_m = {0.1 * number, 0.0, ground_m(0.1 * number, 0.0)};
    const Pose T_map_sensor = body * sensor->T_body_sensor;
    for (int row = 0; row < projection->rows; ++row) {
      out.row_time.push_back(out.time);
      out.T_map_body.push_back(body);
      for (int column = 0; column < projection->columns; ++column) {
        const PixelRay ray = pixel_ray(projection->config, row, column);
        const Eigen::Vector3d d = T_map_sensor.rotation * ray.direction;
        if (d.z() > -0.03) continue;
        const double t = first_hit_m(T_map_sensor.translation_m, d);
        out.range_m(row, column) = static_cast<float>(t + 0.02 * random_normals(7, 1, column, row + 1000 * number)[0]);
      }
    }
    return out;
  }

  std::shared_ptr<const SensorConfig> sensor;
  std::shared_ptr<const Projection> projection;
};

std::vector<RangeFrame> drive(int rows, int columns) {
  const Scanner scanner(rows, columns);
  std::vector<RangeFrame> frames;
  for (int i = 0; i < 12; ++i) frames.push_back(scanner.frame(i));
  return frames;
}

void BM_Step(benchmark::State& state) {
  const auto frames = drive(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  SerialExecutor serial;
  MapConfig config;
  config.size_cells = static_cast<int>(state.range(2));
  Mapper mapper(config, serial);
  std::size_t i = 0;
  for (int warm = 0; warm < 12; ++warm) static_cast<void>(static_cast<bool>(mapper.step(frames[i++ % frames.size()])));
  double measured = 0.0;
  std::array<double, kStages> stages{};
  for (auto _ : state) {
    const auto report = mapper.step(frames[i++ % frames.size()]);
    if (!report) state.SkipWithError("step failed");
    for (std::size_t s = 0; s < kStages; ++s)
      stages[s] += std::chrono::duration<double, std::milli>((*report).stages.of[s]).count();
    measured = static_cast<double>(mapper.snapshot()->measured_cells());
  }
  state.counters["measured_cells"] = measured;
  for (std::size_t s = 0; s < kStages; ++s)
    state.counters[std::string(kStageNames[s])] = benchmark::Counter(stages[s], benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_Step)
    ->Args({256, 256, 200})
    ->Args({480, 640, 200})
    ->Args({64, 1024, 200})
    ->Args({64, 1024, 400})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace scree::mapping

BENCHMARK_MAIN();
