// What a test of one small scene may ask for: the same scene over many seeds.

#include "tests/bench/map/quantiles.hpp"
#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/small_scene.hpp"

namespace scree::bench {
namespace {

void row(const std::string& name, const std::vector<double>& values) {
  Errors sum;
  std::vector<double> known;
  for (const double v : values)
    if (!std::isnan(v)) known.push_back(v), sum.add(v);
  if (known.empty()) return;
  print_text(fmt::format("| {} | {:+.3f} | {:.3f} | {:+.3f} | {:+.3f} |", name, sum.mean(), sum.sd(),
                         quantile(known, 0.0), quantile(known, 1.0)));
}

}  // namespace

void spread_section() {
  print_text(R"(
## The small scene of the tests

Four frames of the lidar over D 2.4 (tests/mapping/traversability_test.cpp), over seeds that the test does not use.

| figure | mean | sd over seeds | least | largest |
|---|---|---|---|---|)");
  const auto all =
      over_surfaces(surfaces(20), [](int i) { return judge_small_scene(600 + static_cast<std::uint64_t>(i)); });
  const auto gather = [&](const auto& figure) {
    std::vector<double> values;
    for (const Judgement& j : all) values.push_back(figure(j));
    return values;
  };
  const auto area = [](const Judgement& j, Method m) { return j.scores[kAllCells][m].auc(); };
  row("share of impassable cells",
      gather([](const Judgement& j) { return j.scores[kAllCells][kCost].share_impassable(); }));
  row("area under the ROC of cost", gather([&](const Judgement& j) { return area(j, kCost); }));
  row("of cost less that of relief", gather([&](const Judgement& j) { return area(j, kCost) - area(j, kRelief); }));
  row("of cost less that of slope, step, roughness",
      gather([&](const Judgement& j) { return area(j, kCost) - area(j, kPlane); }));
  row("of risk less that of relief", gather([&](const Judgement& j) { return area(j, kRisk) - area(j, kRelief); }));
  row("of risk less that of slope, step, roughness",
      gather([&](const Judgement& j) { return area(j, kRisk) - area(j, kPlane); }));
  row("of risk less that of fill, footprint",
      gather([&](const Judgement& j) { return area(j, kRisk) - area(j, kFootprint); }));
  row("of risk less that of relief, reconstructed cells", gather([](const Judgement& j) {
        const auto& scores = j.scores[kReconstructedCells];
        return scores[kRisk].auc() - scores[kRelief].auc();
      }));
  row("coverage, measured", gather([](const Judgement& j) { return j.heights.measured.coverage(); }));
  row("coverage, reconstructed in open sight", gather([](const Judgement& j) {
        fractal::PredictionScore sum;
        for (const auto& s : j.heights.open) sum += s;
        return sum.coverage();
      }));
}

}  // namespace scree::bench
