// Range frame → points on one core, filters and phase resolution on. Figures in docs/perceptron.md.

#include <benchmark/benchmark.h>
#include <cmath>
#include <limits>
#include <memory>

#include "core/random.hpp"
#include "drivers/frame/point_frame.hpp"

namespace scree {
namespace {

/// Gentle waves of ground seen from 1.6 m, 2 % random counts.
std::shared_ptr<RangeFrame> ground_frame(ProjectionKind kind, int rows, int columns) {
  ProjectionConfig config;
  config.kind = kind;
  config.fx_px = config.fy_px = 0.8 * columns;
  config.cx_px = 0.5 * columns;
  config.cy_px = 0.5 * rows;
  auto frame = std::make_shared<RangeFrame>();
  frame->projection = *make_projection(config, rows, columns);
  auto sensor = std::make_shared<SensorConfig>();
  const bool pinhole = kind == ProjectionKind::pinhole;
  Eigen::Matrix3d axes;
  if (pinhole)
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  else
    axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  sensor->T_body_sensor.rotation = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(axes);
  sensor->T_body_sensor.translation_m = {0.3, 0.0, 1.6};
  sensor->noise.sigma_m = 0.01;
  sensor->filter.range_max_m = 39.0;
  sensor->filter.self_mask = BodyBox{{-0.5, -0.4, 0.0}, {0.4, 0.4, 1.5}};
  frame->sensor = sensor;
  frame->row_time.assign(static_cast<std::size_t>(rows), Time{});
  frame->T_map_body.assign(static_cast<std::size_t>(rows), Pose{});
  frame->range_m.assign(rows, columns, std::numeric_limits<float>::quiet_NaN());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const PixelRay ray = pixel_ray(frame->projection->config, r, c);
      const Eigen::Vector3d direction = sensor->T_body_sensor.rotation * ray.direction;
      if (direction.z() > -0.03) continue;
      const double flat_m = -1.6 / direction.z();
      const double wave_m = 0.05 * std::sin(3.0 * flat_m * direction.x()) * std::cos(2.0 * flat_m * direction.y());
      const double range_m = (1.6 - wave_m) / -direction.z() + 0.01 * random_normals(1, 0, c, r)[0];
      double count = std::round(count_at_range(ray, range_m));
      const auto words = random_words(1, 1, c, r);
      if (to_uniform(words[0]) < 0.02) count = words[1] % 4096;
      if (!pinhole) count = wrapped_count(count);
      frame->range_m(r, c) = static_cast<float>(ray.range_offset_m + count * ray.range_per_count_m);
    }
  return frame;
}

void convert(benchmark::State& state, ProjectionKind kind, bool mapped) {
  const auto frame = ground_frame(kind, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const GroundLookup ground = mapped ? GroundLookup([](double x, double) -> std::optional<GroundHeight> {
    if (x > 10.0) return std::nullopt;
    return GroundHeight{0.0, 0.05};
  })
                                     : GroundLookup();
  PointConverter converter;
  SerialExecutor executor;
  PointFrame points;
  for (auto _ : state) {
    const auto status = converter.convert(*frame, ground, executor, points);
    if (!status) state.SkipWithError(status.error().message.c_str());
    benchmark::DoNotOptimize(points.x_m.data());
  }
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["points"] = static_cast<double>(points.size());
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(1));
}

BENCHMARK_CAPTURE(convert, perceptron_cmu, ProjectionKind::perceptron_cmu, false)->Args({256, 256});
BENCHMARK_CAPTURE(convert, perceptron_cmu_mapped, ProjectionKind::perceptron_cmu, true)->Args({256, 256});
BENCHMARK_CAPTURE(convert, perceptron_usf, ProjectionKind::perceptron_usf, true)->Args({512, 512});
BENCHMARK_CAPTURE(convert, depth_camera, ProjectionKind::pinhole, false)->Args({480, 640});

}  // namespace
}  // namespace scree

BENCHMARK_MAIN();
