// Breaks at cliffs and rocks: errors and calibration near them and away.

#include <array>

#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/broken_scene.hpp"
#include "tests/reconstruction/outlier_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.3, 2.5, 2.7};
constexpr int kSide = 256;

struct Pair {
  PredictionScore near, away;
};

Pair judge(const SparseScene& scene, const Grid<std::int32_t>* edge2, bool breaks) {
  SerialExecutor serial;
  SurfaceRequest request;
  request.grid = {kSide, kSide, kSceneCellM};
  request.law.law = scene.law;
  request.draws = 0;
  const auto estimate =
      reconstruct_conditional(cells_of(scene), request, {.gate_outliers = false, .break_edges = breaks}, serial);
  const auto of = [&](bool near) {
    return score_prediction(
        scene.truth, estimate->mean_m, estimate->sd_m, scene.law.rms_change_m(kSceneCellM), [&](int r, int c) {
          return std::isnan(scene.height(r, c)) && (edge2 != nullptr && (*edge2)(r, c) <= 16) == near;
        });
  };
  return {of(true), of(false)};
}

std::array<std::array<Pair, 2>, kDimensions.size()> judge_all(double density, bool broken) {
  std::array<std::array<Pair, 2>, kDimensions.size()> sums;
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const auto& one : over_surfaces(surfaces(12), [&](int i) {
           const auto seed = static_cast<std::uint64_t>(i);
           if (!broken) {
             const SparseScene scene(kDimensions[d], kSide, kSide, density, seed, 0.1);
             return std::array{judge(scene, nullptr, false), judge(scene, nullptr, true)};
           }
           const BrokenScene scene(kDimensions[d], kSide, kSide, density, seed);
           return std::array{judge(scene, &scene.edge2, false), judge(scene, &scene.edge2, true)};
         }))
      for (std::size_t m = 0; m < 2; ++m) {
        sums[d][m].near += one[m].near;
        sums[d][m].away += one[m].away;
      }
  return sums;
}

void print_scores(double density, bool broken) {
  const auto sums = judge_all(density, broken);
  print_head("", kDimensions);
  const auto row = [&](const std::string& name, auto cell) {
    for (std::size_t m = 0; m < 2; ++m)
      print_row(name + (m == 0 ? ", plain" : ", breaks"), sums.size(), [&](std::size_t d) { return cell(sums[d][m]); });
  };
  if (broken) {
    row("RMSE near", [](const Pair& p) { return fixed(p.near.rmse(), 2); });
    row("CRPS near", [](const Pair& p) { return fixed(p.near.crps(), 2); });
    row("90 % interval covers near", [](const Pair& p) { return fixed(p.near.coverage(), 3); });
  }
  row("RMSE away", [](const Pair& p) { return fixed(p.away.rmse(), 3); });
  row("CRPS away", [](const Pair& p) { return fixed(p.away.crps(), 4); });
  row("90 % interval covers away", [](const Pair& p) { return fixed(p.away.coverage(), 3); });
}

}  // namespace

void cliffs_section() {
  print_text(R"(
## Cliffs and rocks

256 × 256 cells of exact surfaces with a cliff of 25 changes over one cell across them and 5 rocks of 10 … 20, noise
variance 1e-2 of its square; 8 residual fields, 12 scenes a column. Near: within four cells of such an edge. Cells
without a datum, in units of the change over one cell.
)");
  for (const double density : {0.05, 0.2}) {
    print_text(fmt::format("\n{:g} % of the cells measured.\n", 100 * density));
    print_scores(density, true);
  }
  print_text("\nThe price of breaks where there are none: the same ground without cliff and rocks, 5 % measured.\n");
  print_scores(0.05, false);
  const BrokenScene scene(2.5, kSide, kSide, 0.05, 0);
  const auto times = times_of({[&] { judge(scene, nullptr, false); }, [&] { judge(scene, nullptr, true); }});
  print_text(
      fmt::format("\nTime of mean, sd and 8 fields at D = 2.5, 5 %, one core: {:.0f} ms plain, {:.0f} ms with "
                  "breaks.",
                  times[0].cpu_ms, times[1].cpu_ms));
}

}  // namespace scree::bench
