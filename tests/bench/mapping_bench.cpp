// The mapper on one core: whole steps for the frame sizes that must keep up (256 x 256 at 20 frames/s, 640 x 480 at
// 5 frames/s), and its stages alone. A robot drives 0.1 m a frame over an fBm surface (D = 2.3, 0.1 m at 1 m).

#include <benchmark/benchmark.h>
#include <cmath>
#include <limits>
#include <memory>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "mapping/alignment.hpp"
#include "mapping/cell_points.hpp"
#include "mapping/fusion.hpp"
#include "mapping/layers.hpp"
#include "mapping/mapper.hpp"
#include "mapping/visibility.hpp"

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

/// 60° x 60° spherical scanner, 1.6 m up, tilted 25° down, 2 cm noise.
struct Scanner {
  Scanner(int rows, int columns) {
    ProjectionConfig config;
    config.kind = ProjectionKind::spherical;
    config.range_per_count_m = 0.001;
    config.ambiguity_m = 0.0;
    for (int r = 0; r < rows; ++r) config.row_elevations_rad.push_back(0.52 - 1.04 * (r + 0.5) / rows);
    for (int c = 0; c < columns; ++c) config.column_azimuths_rad.push_back(0.52 - 1.04 * (c + 0.5) / columns);
    auto made = std::make_shared<SensorConfig>();
    made->projection = config;
    made->T_body_sensor.translation_m = {0.3, 0.0, 1.6};
    made->T_body_sensor.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.44, Eigen::Vector3d::UnitY()));
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
  double measured = 0.0;
  for (auto _ : state) {
    if (const auto report = mapper.step(frames[i++ % frames.size()]); !report) state.SkipWithError("step failed");
    measured = static_cast<double>(mapper.snapshot()->measured_cells());
  }
  state.counters["measured_cells"] = measured;
}
BENCHMARK(BM_Step)->Args({256, 256, 200})->Args({480, 640, 200})->Args({480, 640, 400})->Unit(benchmark::kMillisecond);

/// The stages on one converted frame; range(2): 0 convert, 1 sort and fuse, 2 visibility, 3 layers, 4
/// fit the frame to the map.
void BM_Stage(benchmark::State& state) {
  const RangeFrame frame = Scanner(static_cast<int>(state.range(0)), static_cast<int>(state.range(1))).frame(0);
  SerialExecutor serial;
  MapConfig config;
  const auto cell_m = static_cast<float>(config.cell_m);
  PointConverter converter;
  PointFrame points;
  RollingGrid<MapCell> map(config.size_cells, config.size_cells, {});
  map.roll_to({-config.size_cells / 2, -config.size_cells / 2});
  CellPoints cell_points;
  const GroundConfig ground{cell_m, 1.0F, 5.0F};
  FrameReturns returns;
  Alignment alignment;
  Fusion fusion(ground);
  VisibilityConfig visibility_config;
  Visibility visibility(visibility_config);
  Layers layers(config);
  MapSnapshot out;
  out.window = map.window();
  const auto run = [&](std::int64_t stage) {
    if (stage == 0) static_cast<void>(static_cast<bool>(converter.convert(frame, {}, serial, points)));
    if (stage == 1) {
      cell_points.sort(points, map.window(), config.cell_m, serial);
      returns.gather(points, {}, cell_points, map, ground, serial);
      fusion.fuse(returns, 0, GateLaw(), serial, map);
    }
    if (stage == 2) visibility.update(points, cell_points, {}, serial, map);
    if (stage == 3) layers.compute(map, 0, serial, out);
    if (stage == 4) static_cast<void>(alignment.fit(points, config.cell_m, map, returns));
  };
  for (const int stage : {0, 1, 2, 3, 1, 4}) run(stage);
  for (auto _ : state) run(state.range(2));
}
BENCHMARK(BM_Stage)->ArgsProduct({{256}, {256}, {0, 1, 2, 3, 4}})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Stage)->ArgsProduct({{480}, {640}, {0, 1, 2, 3, 4}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace scree::mapping

BENCHMARK_MAIN();
