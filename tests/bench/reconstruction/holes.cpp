// Where in the holes of smooth ground the conditional method loses against exact kriging.

#include <array>

#include "fractal/reconstruction/kriging.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/bench/reconstruction/varying_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kTolerances = {0.02, 0.005, 0.0005};
constexpr std::array kPlaces = {"≤ 4 cells from data", "farther, inside", "farther, < 8 cells from the border"};

/// Sums of squared errors: exact kriging, then the tolerances.
struct Squares {
  std::array<std::array<double, kTolerances.size() + 1>, kPlaces.size()> sum = {};
  std::array<double, kPlaces.size()> cells = {};
};

Squares judge(const VaryingCase& c, std::uint64_t seed) {
  const VaryingScene scene(c, seed);
  const LawMap law{c.one, {}, {}};
  SerialExecutor serial;
  std::vector<Grid<float>> means = {
      reconstruct_kriging(scene.samples, {{c.side, c.side, 1.0}, law, 0, 1, {}, {}}, {}, serial)->mean_m};
  for (const double tolerance : kTolerances) means.push_back(mean_of(scene, law, tolerance));
  const Grid<float> distance = distance_to_data(scene.samples.height_m);
  Squares out;
  for (int r = 0; r < c.side; ++r)
    for (int x = 0; x < c.side; ++x) {
      if (scene.measured(r, x)) continue;
      const int border = std::min({r, x, c.side - 1 - r, c.side - 1 - x});
      const std::size_t place = distance(r, x) <= 4.0F ? 0 : border >= 8 ? 1 : 2;
      out.cells[place] += 1.0;
      for (std::size_t m = 0; m < means.size(); ++m)
        out.sum[place][m] += std::pow(static_cast<double>(scene.truth(r, x) - means[m](r, x)), 2);
    }
  return out;
}

}  // namespace

void holes_section() {
  print_text(R"(
## Holes in smooth ground

One law, D 2.15 and change .3, 24 surfaces of 96 × 96 cells, 7 % measured and three holes of radius 11, noise variance 1e-3:
RMSE of exact kriging, and of the conditional mean over it, solved for to ε (.02 is what it takes for such ground).
)");
  print_row("cells", 2 + kTolerances.size(), [](std::size_t i) -> std::string {
    return i == 0 ? "a surface" : i == 1 ? "exact kriging" : fmt::format("ε = {:g}", kTolerances[i - 2]);
  });
  std::puts("|---|---|---|---|---|---|");
  const VaryingCase c{"sand, holes", Layout::halves, kSand, kSand, true, 96};
  const int count = surfaces(24);
  Squares total;
  for (const Squares& one :
       over_surfaces(count, [&](int k) { return judge(c, kFirstSeed + static_cast<std::uint64_t>(k)); }))
    for (std::size_t p = 0; p < kPlaces.size(); ++p) {
      total.cells[p] += one.cells[p];
      for (std::size_t m = 0; m < one.sum[p].size(); ++m) total.sum[p][m] += one.sum[p][m];
    }
  for (std::size_t p = 0; p < kPlaces.size(); ++p)
    print_row(kPlaces[p], 2 + kTolerances.size(), [&](std::size_t i) {
      if (i == 0) return fixed(total.cells[p] / count, 0);
      if (i == 1) return fixed(std::sqrt(total.sum[p][0] / total.cells[p]), 3);
      return fixed(std::sqrt(total.sum[p][i - 1] / total.sum[p][0]), 3);
    });
}

}  // namespace scree::bench
