// D of each cell against the D of the ground.

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"
#include "tests/bench/map/quantiles.hpp"

namespace scree::bench {
namespace {

double covered(const DimensionScores& s) {
  double inside = 0.0;
  for (std::size_t i = 0; i < s.errors.size(); ++i)
    inside +=
        static_cast<double>(std::abs(s.errors[i])) < fractal::kNormal95 * static_cast<double>(s.sigmas[i]) ? 1.0 : 0.0;
  return inside / static_cast<double>(s.errors.size());
}

double rms(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float v : values) sum += static_cast<double>(v) * static_cast<double>(v);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void row(const std::string& name, const Scenes& scenes) {
  const DimensionScores s = total(scenes, &Judgement::roughness);
  if (s.errors.empty()) return;
  const auto cells = static_cast<double>(s.errors.size());
  const Interval coverage =
      bootstrap(scenes, [](const Scenes& drawn) { return covered(total(drawn, &Judgement::roughness)); });
  print_text(fmt::format("| {} | {:.0f} | {:.1f} % | {} | {:.3f} | {:.3f} | {} | {:.2f} |", name, cells,
                         100.0 * s.flagged / (s.flagged + cells), with_sign(quantile(s.errors, 0.5), 3), rms(s.errors),
                         quantile(s.sigmas, 0.5), interval_text(coverage, 2), quantile(s.relief_ratios, 0.5)));
}

}  // namespace

void roughness_section() {
  print_text(R"(
## D of each cell

Of cells whose window holds neither rock nor ditch (1.25 m away, Chebyshev). Errors, coverage of D ± 1.645 sigma_D and the
ratio of the rms change over 0.3 m by D and amplitude to the true one are those of cells without a flag.)");
  for (const SensorResults& r : campaign()) {
    print_text("\n### D, " + r.sensor);
    print_text(
        "\n| D | cells | flagged | median error | rms error | median sigma_D | coverage | change over 0.3 m / true |\n"
        "|---|---|---|---|---|---|---|---|");
    for (const double d : kDimensions)
      if (const Scenes scenes = scenes_of(r.scenes, d); !scenes.empty()) row(fixed(d, 1), scenes);
    row("all", scenes_of(r.scenes));
  }
}

}  // namespace scree::bench
