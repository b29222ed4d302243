// How much the blend prior loses against the exact law.

#include <array>

#include "tests/bench/reconstruction/method_scores.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};

struct Pair {
  MethodScore exact, conditional;
};

Pair judge(double dimension, std::uint64_t seed) {
  const SparseScene scene(dimension, kMethodSide, kMethodSide, 0.05, seed);
  const MethodResult exact = run_kriging(scene, seed + 1), conditional = run_conditional(scene, seed + 1);
  Pair pair;
  pair.exact.add(scene, exact, 1.0);
  pair.conditional.add(scene, conditional, 1.0, &exact.estimate.sd_m);
  return pair;
}

struct Column {
  Pair sum;
  double worst = 0.0;  // RMSE ratio of one surface
  double ratio(double (MethodScore::*figure)() const) const {
    return (sum.conditional.*figure)() / (sum.exact.*figure)();
  }
};

}  // namespace

void kriging_section() {
  const int count = surfaces(6);
  print_text(fmt::format(R"(
## The conditional method against exact kriging

The same {} surfaces a D as above, both methods. CRPS and coverage in the same 2 % of the cells: kriging with its exact
sd, the conditional method with its own (8 residual fields and the regression).
)",
                         count));
  std::array<Column, kDimensions.size()> columns;
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const Pair& one :
         over_surfaces(count, [&](int i) { return judge(kDimensions[d], static_cast<std::uint64_t>(i)); })) {
      columns[d].sum.exact += one.exact;
      columns[d].sum.conditional += one.conditional;
      columns[d].worst = std::max(columns[d].worst, one.conditional.rmse() / one.exact.rmse());
    }
  print_head("", kDimensions);
  const auto row = [&](const std::string& name, auto cell) {
    print_row(name, columns.size(), [&](std::size_t c) { return cell(columns[c]); });
  };
  const auto mean = [&](double (MethodScore::*figure)() const) {
    double sum = 0.0;
    for (const Column& column : columns) sum += column.ratio(figure) / static_cast<double>(columns.size());
    return sum;
  };
  row("RMSE of the mean, ratio (worst surface)",
      [](const Column& c) { return fixed(c.ratio(&MethodScore::rmse), 3) + fmt::format(" ({:.3f})", c.worst); });
  row("RMSE of a draw, ratio", [](const Column& c) { return fixed(c.ratio(&MethodScore::draw_rmse), 3); });
  row("CRPS, ratio", [](const Column& c) { return fixed(c.ratio(&MethodScore::crps), 3); });
  row("90 % interval covers: kriging / conditional", [](const Column& c) {
    return fixed(c.sum.exact.score.coverage(), 3) + " / " + fixed(c.sum.conditional.score.coverage(), 3);
  });
  row("D^ − D*: kriging / conditional", [](const Column& c) {
    return with_sign(c.sum.exact.roughness.mean(), 3) + " / " + with_sign(c.sum.conditional.roughness.mean(), 3);
  });
  const double rmse = mean(&MethodScore::rmse), crps = mean(&MethodScore::crps);
  print_text(fmt::format("\nOver all D: RMSE {:.4f} of kriging's (target ≤ 1.02: {}), CRPS {:.4f} (≤ 1.016: {}).", rmse,
                         at_most(rmse, 1.02), crps, at_most(crps, 1.016)));
}

}  // namespace scree::bench
