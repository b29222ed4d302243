// Heights against the mean of the true ground in the cell.

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"

namespace scree::bench {
namespace {

using fractal::PredictionScore;

constexpr std::array kDistanceNames = {"1", "2–3", "3–6", "6–12"};
constexpr double kFewCells = 300.0;

/// One kind of cell: its sums, and where it is biased.
struct Kind {
  std::string name;
  std::function<PredictionScore(const HeightScores&)> score;
  std::function<double(const HeightScores&)> bias_sum;
};

std::vector<Kind> kinds() {
  std::vector<Kind> out = {
      {"measured", [](const HeightScores& h) { return h.measured; },
       [](const HeightScores& h) { return h.measured_bias; }},
      {"measured, within 0.3 m of rocks and ditch", [](const HeightScores& h) { return h.measured_objects; }, {}}};
  for (const bool open : {true, false})
    for (std::size_t d = 0; d < kDistances; ++d)
      out.push_back({fmt::format("reconstructed, {}, {} cells away", open ? "in open sight" : "in the ground's shadow",
                                 kDistanceNames[d]),
                     [open, d](const HeightScores& h) { return (open ? h.open : h.shadow)[d]; },
                     [open, d](const HeightScores& h) { return (open ? h.open_bias : h.shadow_bias)[d]; }});
  out.push_back({"reconstructed, within 0.3 m of rocks and ditch",
                 [](const HeightScores& h) { return h.reconstructed_objects; },
                 {}});
  return out;
}

Interval coverage(const Scenes& scenes, const Kind& kind) {
  return bootstrap(scenes,
                   [&](const Scenes& drawn) { return kind.score(total(drawn, &Judgement::heights)).coverage(); });
}

void kind_row(const Scenes& scenes, const Kind& kind) {
  const HeightScores sums = total(scenes, &Judgement::heights);
  const PredictionScore s = kind.score(sums);
  if (s.cells == 0.0) return;
  const std::string bias = kind.bias_sum ? with_sign(1e3 * kind.bias_sum(sums) / s.cells, 1) : "";
  print_text(fmt::format("| {} | {:.0f} | {:.1f} | {} | {} | {:.2f} | {:.1f} |", kind.name, s.cells, 1e3 * s.rmse(),
                         bias, interval_text(coverage(scenes, kind)), std::sqrt(s.normalised / s.cells),
                         1e3 * s.crps()));
}

PredictionScore open_sum(const HeightScores& h) {
  PredictionScore sum;
  for (const PredictionScore& s : h.open) sum += s;
  return sum;
}
PredictionScore shadow_sum(const HeightScores& h) {
  PredictionScore sum;
  for (const PredictionScore& s : h.shadow) sum += s;
  return sum;
}

std::string by_dimension(const PredictionScore& s) {
  return s.cells < kFewCells ? "—" : fmt::format("{:.1f}, {:.3f}", 1e3 * s.rmse(), s.coverage());
}

void dimension_table(const SensorResults& r) {
  print_text(
      "\n| D | measured: rmse (mm), coverage | measured: bias (mm) | reconstructed, open sight | reconstructed, shadow "
      "|\n|---|---|---|---|---|");
  for (const double d : kDimensions) {
    const Scenes scenes = scenes_of(r.scenes, d);
    if (scenes.empty()) continue;
    const HeightScores h = total(scenes, &Judgement::heights);
    print_text(fmt::format("| {:.1f} | {} | {} | {} | {} |", d, by_dimension(h.measured),
                           with_sign(1e3 * h.measured_bias / std::max(h.measured.cells, 1.0), 1),
                           by_dimension(open_sum(h)), by_dimension(shadow_sum(h))));
  }
}

}  // namespace

void heights_section() {
  print_text(R"(
## Heights

Against the mean of the true surface in the cell; coverage of the interval mean ± 1.645 sigma with its 95 % interval over
scenes. Cells within 0.3 m of a rock or the ditch stand apart. *Open sight*: some frame's sensor had the cell in its field
of view with nothing before it, so that the scan's spacing alone kept it from being measured; *shadow*: the ground itself
hid it, always. The target .88–.92 is for open sight and measured cells.)");
  for (const SensorResults& r : campaign()) {
    print_text("\n### Heights, " + r.sensor);
    print_text(
        "\n| cells | number | rmse (mm) | bias (mm) | coverage | rms of error/sigma | CRPS (mm) |\n"
        "|---|---|---|---|---|---|---|");
    const Scenes scenes = scenes_of(r.scenes);
    for (const Kind& kind : kinds()) kind_row(scenes, kind);
    const HeightScores h = total(scenes, &Judgement::heights);
    const auto verdict = [](const PredictionScore& s) {
      return s.cells < kFewCells ? std::string("no cells") : within(s.coverage(), 0.88, 0.92);
    };
    print_text(fmt::format("\nCoverage of .88–.92: measured {}; reconstructed in open sight {}.", verdict(h.measured),
                           verdict(open_sum(h))));
    dimension_table(r);
  }
}

}  // namespace scree::bench
