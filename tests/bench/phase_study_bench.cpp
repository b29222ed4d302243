// The measured tables of docs/perceptron.md ("Which interval"): prints them. Some two minutes.

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

}  // namespace
}  // namespace scree

int main() {
  scree::print_walls();
  for (const double rms_1m : {0.05, 0.1, 0.2}) {
    scree::print_rough(scree::ProjectionKind::perceptron_usf, 512, rms_1m);
    scree::print_rough(scree::ProjectionKind::perceptron_cmu, 256, rms_1m);
  }
}
