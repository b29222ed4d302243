#include "tests/bench/reconstruction/varying_scene.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "tests/bench/reconstruction/modulated_truth.hpp"

namespace scree::bench {

using namespace fractal;

namespace {

/// Share of the second law at a cell.
double share(const VaryingCase& c, int row, int column, double width) {
  const auto step = [width](double inside) { return 0.5 + 0.5 * std::erf(inside / (std::sqrt(2.0) * width)); };
  if (c.layout == Layout::halves) return step(column - 0.5 * (c.side - 1));
  if (c.layout == Layout::ramp) return column / (c.side - 1.0);
  constexpr std::array<std::array<double, 3>, 4> kDiscs = {{{32, 30, 22}, {94, 36, 16}, {36, 96, 18}, {98, 98, 20}}};
  double best = 0.0;
  for (const auto& [r, x, radius] : kDiscs) best = std::max(best, step(radius - std::hypot(row - r, column - x)));
  return best;
}

bool in_hole(int side, std::uint64_t seed, int r, int x) {
  const auto holes = std::lround(6.0 * side * side / (128.0 * 128.0));
  for (int hole = 0; hole < holes; ++hole) {
    const auto words = random_words(seed, 8, hole, 0);
    if (std::hypot(r - side * to_uniform(words[0]), x - side * to_uniform(words[1])) < 11.0) return true;
  }
  return false;
}

}  // namespace

LawMap law_of(const VaryingCase& c, double width) {
  LawMap law{{0.5 * (c.one.dimension + c.two.dimension), std::sqrt(c.one.amplitude_m * c.two.amplitude_m)},
             Grid<float>(c.side, c.side),
             Grid<float>(c.side, c.side)};
  for (int r = 0; r < c.side; ++r)
    for (int x = 0; x < c.side; ++x) {
      const double t = share(c, r, x, width);
      law.dimension(r, x) = static_cast<float>(c.one.dimension + t * (c.two.dimension - c.one.dimension));
      law.amplitude_m(r, x) =
          static_cast<float>(c.one.amplitude_m * std::pow(c.two.amplitude_m / c.one.amplitude_m, t));
    }
  return law;
}

std::size_t zone_of(const VaryingCase& c, int row, int column) {
  const double t = share(c, row, column, c.width < 1.0 ? 6.2 : c.width);
  return t < 0.1 ? 0 : t < 0.9 ? 1 : 2;
}

VaryingScene::VaryingScene(const VaryingCase& c, std::uint64_t seed)
    : law(law_of(c, c.seen_width())),
      truth(modulated_truth(law_of(c, c.width), seed)),
      samples{Grid<float>(c.side, c.side, NAN), Grid<float>(c.side, c.side, NAN),
              Grid<std::uint16_t>(c.side, c.side, 0)} {
  const double sigma = std::sqrt(kNoise);
  for (int r = 0; r < c.side; ++r)
    for (int x = 0; x < c.side; ++x) {
      if (to_uniform(random_words(seed, 5, x, r)[0]) >= (c.holes ? 0.07 : 0.05)) continue;
      if (c.holes && in_hole(c.side, seed, r, x)) continue;
      samples.height_m(r, x) = truth(r, x) + static_cast<float>(sigma * random_normals(seed, 6, x, r)[0]);
      samples.variance_m2(r, x) = static_cast<float>(kNoise);
      samples.hits(r, x) = 1;
      ++samples.cells;
    }
}

void score_zones(const VaryingCase& c, const VaryingScene& scene, const VaryingAnswer& answer, ZoneScores& scores) {
  for (int r = 0; r < c.side; ++r)
    for (int x = 0; x < c.side; ++x)
      if (!scene.measured(r, x))
        scores[zone_of(c, r, x)].add(static_cast<double>(scene.truth(r, x) - answer.mean(r, x)),
                                     static_cast<double>(answer.sd(r, x)));
}

}  // namespace scree::bench
