// The measured tables of docs/perceptron.md ("Which interval"): prints them. Some two minutes; with any
// argument the drops and walls only, some ten seconds.

#include <array>
#include <cstdio>
#include <optional>

#include "tests/frame/phase_outcome.hpp"

namespace scree {
namespace {

using namespace test;

SensorConfig sensor_at(double pitch_rad, double range_max_m) {
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, pitch_rad, 0.3);
  sensor.noise.sigma_m = 0.01;
  sensor.filter.range_min_m = 0.5;
  sensor.filter.range_max_m = range_max_m;
  return sensor;
}

void print_rough(ProjectionKind kind, int side, double rms_1m) {
  const auto projection = projection_of(kind, side, side);
  const RoughGround ground(rms_1m, 5);
  const auto seen = scan(projection, sensor_at(0.45, 39.0), standing(), ground, 0.01);
  const GroundLookup known = [&](double x, double y) -> std::optional<GroundHeight> {
    if (std::hypot(x, y) > 8.0) return std::nullopt;
    return GroundHeight{ground.height(x, y), 0.03};
  };
  for (const bool mapped : {false, true}) {
    const auto result = convert_and_compare(seen, mapped ? known : GroundLookup());
    std::printf("%s %d, %.2f m, map %s: %zu points, %d wrong; share within", to_string(kind), side, rms_1m,
                mapped ? "8 m" : "none", result.points.size(), result.wrong);
    for (const float limit_m : {4.0F, 8.0F, 12.0F, 24.0F})
      std::printf("  %.0f m %.3f", static_cast<double>(limit_m),
                  static_cast<double>(points_within(result.points, limit_m)) /
                      static_cast<double>(pixels_within(seen, limit_m)));
    std::printf("\n");
  }
}

void print_walls() {
  const auto projection = projection_of(ProjectionKind::perceptron_usf, 128, 128);
  const Scene ground = plane({0, 0, 0}, {0, 0, 1});
  std::size_t points = 0, wrong = 0, frames = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto result = convert_and_compare(
        scan(projection, sensor_at(0.4, 33.0), standing(), nearest(ground, random_walls(seed)), 0.01), {});
    points += result.points.size();
    wrong += static_cast<std::size_t>(result.wrong);
    frames += result.wrong > 0 ? 1U : 0U;
  }
  std::printf("walls: %zu wrong of %zu points, in %zu of 400 frames\n", wrong, points, frames);
}

/// Level ground at 0 up to `edge_m` ahead of the body, and a level floor `depth_m` below it from there on.
Scene quarry(double edge_m, double depth_m) {
  return nearest(part(plane({0, 0, 0}, {0, 0, 1}), [=](const auto& p) { return p.x() < edge_m; }),
                 plane({0, 0, -depth_m}, {0, 0, 1}));
}

struct Tally {
  std::size_t frames = 0, wrong_frames = 0, points = 0, wrong = 0;
  void add(const Scan& seen) {
    const auto result = convert_and_compare(seen, {});
    ++frames;
    points += result.points.size();
    wrong += static_cast<std::size_t>(result.wrong);
    wrong_frames += result.wrong > 0 ? 1U : 0U;
  }
};

/// No map, no noise: what nothing anchors must not become points of a wrong interval.
void print_drops(ProjectionKind kind) {
  const auto projection = projection_of(kind, 128, 128);
  const SensorConfig sensor = sensor_at(0.45, 100.0);
  for (const double edge_m : {-10.0, 1.0, 1.5, 2.0, 2.7, 4.0, 6.0}) {
    Tally drops;
    for (double depth_m = 2.0; depth_m < 50.0; depth_m += 1.0)
      drops.add(scan(projection, sensor, standing(), quarry(edge_m, depth_m)));
    std::printf("%s, edge %.1f m ahead, floors 2 to 49 m below: %zu wrong of %zu points, in %zu of %zu frames\n",
                to_string(kind), edge_m, drops.wrong, drops.points, drops.wrong_frames, drops.frames);
  }
  Tally walls;
  for (double wall_m = 2.0; wall_m < 80.0; wall_m += 1.0)
    walls.add(scan(projection, sensor, standing(), plane({wall_m, 0, 0}, {-1, 0, 0})));
  std::printf("%s, only a wall 2 to 79 m ahead: %zu wrong of %zu points, in %zu of %zu frames\n", to_string(kind),
              walls.wrong, walls.points, walls.wrong_frames, walls.frames);
}

}  // namespace
}  // namespace scree

int main(int argc, char**) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  for (const auto kind : {scree::ProjectionKind::perceptron_usf, scree::ProjectionKind::perceptron_cmu})
    scree::print_drops(kind);
  if (argc > 1) return 0;
  scree::print_walls();
  for (const double rms_1m : {0.05, 0.1, 0.2}) {
    scree::print_rough(scree::ProjectionKind::perceptron_usf, 512, rms_1m);
    scree::print_rough(scree::ProjectionKind::perceptron_cmu, 256, rms_1m);
  }
}
