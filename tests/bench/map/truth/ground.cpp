#include "tests/bench/map/truth/ground.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace scree::bench {
namespace {

constexpr double kXMin_m = -7.5, kYMin_m = -11.0, kSide_m = 22.0;
constexpr int kRocks = 18;
constexpr std::uint64_t kRockStream = 71, kDitchStream = 72;
constexpr double kDitchDepth_m = 0.5, kDitchWall_m = 0.1;

double between(double low, double high, std::uint32_t word) {
  return low + (high - low) * to_uniform(word);
}

/// Calls body(row, column, x_m, y_m) for every node.
template <class Body>
void for_nodes(const Grid<float>& nodes, const Body& body) {
  for (int row = 0; row < nodes.rows(); ++row)
    for (int column = 0; column < nodes.columns(); ++column)
      body(row, column, kXMin_m + column * kNode_m, kYMin_m + row * kNode_m);
}

std::vector<Rock> place_rocks(std::uint64_t seed) {
  std::vector<Rock> rocks;
  for (int i = 0; static_cast<int>(rocks.size()) < kRocks; ++i) {
    const auto place = random_words(seed, kRockStream, i, 0), size = random_words(seed, kRockStream, i, 1);
    const Rock rock{between(-5.0, 12.0, place[0]), between(-8.0, 8.0, place[1]), between(0.1, 0.4, size[0]),
                    between(0.1, 0.5, size[1])};
    const bool on_way = rock.x_m < 5.0 && std::abs(rock.y_m) < 0.6 + rock.radius_m;
    if (!on_way && std::abs(rock.x_m - 7.5) > 1.5) rocks.push_back(rock);
  }
  return rocks;
}

void add_rocks(Ground& ground) {
  Grid<float>& z = ground.nodes.height_m;
  for (const Rock& rock : ground.rocks) {
    const auto node = [](double v_m, double min_m) { return static_cast<int>(std::lround((v_m - min_m) / kNode_m)); };
    const int row = node(rock.y_m, kYMin_m), column = node(rock.x_m, kXMin_m);
    const int reach = static_cast<int>(std::ceil(rock.radius_m / kNode_m));
    const float base_m = z(row, column);
    for (int r = row - reach; r <= row + reach; ++r)
      for (int c = column - reach; c <= column + reach; ++c) {
        const double rho =
            std::hypot(kXMin_m + c * kNode_m - rock.x_m, kYMin_m + r * kNode_m - rock.y_m) / rock.radius_m;
        if (!z.contains(r, c) || rho >= 1.0) continue;
        const float top_m = base_m + static_cast<float>(rock.height_m * std::sqrt(1.0 - rho * rho));
        if (top_m <= z(r, c)) continue;
        z(r, c) = top_m;
        ground.rock(r, c) = 1;
      }
  }
}

void dig_ditch(Ground& ground, std::uint64_t seed) {
  const auto words = random_words(seed, kDitchStream, 0, 0);
  const double phase = between(0.0, 2.0 * std::numbers::pi, words[0]), half_width_m = between(0.25, 0.4, words[1]);
  for_nodes(ground.nodes.height_m, [&](int row, int column, double x_m, double y_m) {
    const double argument = 0.6 * y_m + phase;
    const double slope = 0.7 * 0.6 * std::cos(argument);  // of the centre line, dx/dy
    const double off_m = std::abs(x_m - 7.5 - 0.7 * std::sin(argument)) / std::hypot(1.0, slope);
    const double share = std::clamp((half_width_m - off_m) / kDitchWall_m + 0.5, 0.0, 1.0);
    if (share <= 0.0) return;
    ground.nodes.height_m(row, column) -= static_cast<float>(share * kDitchDepth_m);
    ground.ditch(row, column) = 1;
  });
}

}  // namespace

Result<Ground> make_ground(const GroundSpec& spec) {
  Ground ground;
  ground.law.dimension = spec.dimension;
  ground.law.amplitude_m = spec.relief_m * std::pow(1.0 / kReliefLag_m, 3.0 - spec.dimension);
  const int side = static_cast<int>(std::lround(kSide_m / kNode_m)) + 1;
  auto surface = fractal::fbm_surface(ground.law, side, side, kNode_m, spec.seed);
  if (!surface) return surface.error();
  // zero where the robot starts: the plane through the origin of fBm is arbitrary
  const float level_m = (*surface)(side / 2, static_cast<int>(std::lround(-kXMin_m / kNode_m)));
  for (float& z_m : *surface) z_m -= level_m;
  ground.nodes.height_m = *std::move(surface);
  ground.nodes.x_min_m = kXMin_m - 0.5 * kNode_m;
  ground.nodes.y_min_m = kYMin_m - 0.5 * kNode_m;
  ground.nodes.cell_m = ground.nodes.cell_y_m = kNode_m;
  ground.rock.assign(side, side, 0);
  ground.ditch.assign(side, side, 0);
  if (spec.objects) {
    ground.rocks = place_rocks(spec.seed);
    add_rocks(ground);
    dig_ditch(ground, spec.seed);
  }
  return ground;
}

}  // namespace scree::bench
