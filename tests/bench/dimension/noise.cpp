// D of many scattered points with noise: known, and estimated beside D.

#include <array>

#include "fractal/vecchia.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.05, 2.2, 2.4, 2.6, 2.8, 2.9};
constexpr double kNoise = 0.3;

struct Column {
  Errors known, unknown, noise;
};

struct Judged {
  DimensionEstimate known, unknown;
};

void table(std::size_t points, int count) {
  std::array<Column, kDimensions.size()> columns;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto all = over_surfaces(surfaces(count), [&](int i) {
      const auto seed = static_cast<std::uint64_t>(i);
      Survey survey = exact_survey(kDimensions[c], seed, points);
      add_plane(survey, 0.5, 0.0);
      add_noise(survey, kNoise, 0.0, seed);
      SurveyPoints unknown = survey.points();
      unknown.noise_unknown = true;
      return Judged{*estimate_dimension_vecchia(survey.points(kNoise)), *estimate_dimension_vecchia(unknown)};
    });
    for (const Judged& one : all) {
      columns[c].known.add(one.known, kDimensions[c]);
      columns[c].unknown.add(one.unknown, kDimensions[c]);
      columns[c].noise.add(one.unknown.noise_sigma_m - kNoise);
    }
  }
  const auto row = [&](const std::string& name, auto cell) { print_row(name, columns.size(), cell); };
  const auto errors = [](const Errors& e) { return with_sign(e.mean(), 3) + ", " + fixed(e.rms(), 3); };
  const std::string name = fmt::format("N = {}, noise ", points);
  row(name + "known: bias, RMSE", [&](std::size_t c) { return errors(columns[c].known); });
  row("covers", [&](std::size_t c) { return fixed(columns[c].known.coverage(), 2) + columns[c].known.unknowns(); });
  row(name + "estimated: bias, RMSE", [&](std::size_t c) { return errors(columns[c].unknown); });
  row("covers", [&](std::size_t c) { return fixed(columns[c].unknown.coverage(), 2) + columns[c].unknown.unknowns(); });
  row("noise found: mean ± sd", [&](std::size_t c) {
    return fixed(kNoise + columns[c].noise.mean(), 3) + " ± " + fixed(columns[c].noise.sd(), 3);
  });
}

}  // namespace

void noise_section() {
  print_text(R"(
## Many scattered points with noise

Cells of 256 × 256 of exact surfaces, slope .5, noise .3 of the rms change over the mean spacing, known or estimated;
100 surfaces a case (standard error of an RMSE 7 %, of a coverage .022). No targets; the bounds of the standard
deviation are, for N = 3277, known: .036 .025 .020 .016 .012 .008, estimated: .043 .035 .033 .036 .045 .059.
)");
  print_head("Vecchia", kDimensions);
  table(1000, 100);
  table(kPaperPoints, 100);
}

}  // namespace scree::bench
