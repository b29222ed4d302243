// Table 1 of [AK96] again: on its generator and on exact ground, with its estimator and with one that knows the noise.

#include <array>
#include <functional>
#include <string>

#include "fractal/loglog_fit.hpp"
#include "fractal/structure_dimension.hpp"
#include "fractal/successive_random_additions.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
constexpr std::size_t kColumns = kDimensions.size();
constexpr std::array kLevels_dB = {30.0, 25.0, 20.0};
constexpr std::size_t kCases = 1 + kLevels_dB.size();  // clean first
constexpr std::array<const char*, kCases> kCaseNames = {"clean", "30 dB", "25 dB", "20 dB"};
/// Table 1: mean errors in % of D.
constexpr std::array<std::array<double, kColumns>, kCases> kPaper = {{
    {8.00, 5.18, 3.17, 1.54, 0.28, -0.65, -1.48, -2.29},
    {8.15, 5.38, 3.20, 1.52, 0.27, -0.68, -1.47, -2.28},
    {9.16, 5.96, 3.50, 1.67, 0.35, -0.63, -1.42, -2.24},
    {13.59, 9.02, 5.42, 2.75, 0.88, -0.38, -1.31, -2.17},
}};

Survey survey_of(bool exact, double dimension, std::uint64_t seed) {
  const FractalLaw law{dimension, 1.0};
  return paper_survey(*(exact ? fbm_surface(law, kPaperSide, kPaperSide, 1.0, seed)
                              : successive_random_additions(law, kPaperSide, kPaperSide, 1.0, seed)),
                      seed);
}

Survey with_noise(Survey survey, std::size_t which, std::uint64_t seed) {
  if (which > 0) {
    const double sigma = paper_noise(kLevels_dB[which - 1]);
    add_noise(survey, sigma, sigma, seed);
  }
  return survey;
}

struct Judged {
  std::array<double, kCases> papers{};
  DimensionEstimate aware{};  // at 20 dB, exact ground only
};

struct Column {
  std::array<Errors, kCases> papers;  // % of D
  Errors aware;                       // % of D, and coverage
};

Column judge(bool exact, double dimension) {
  const auto all = over_surfaces(surfaces(100), [&](int i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const Survey survey = survey_of(exact, dimension, seed);
    Judged out;
    for (std::size_t which = 0; which < kCases; ++which)
      out.papers[which] = papers_estimate(with_noise(survey, which, seed));
    if (!exact) return out;
    SerialExecutor serial;
    const double sigma = paper_noise(kLevels_dB.back());
    out.aware = *estimate_dimension_structure(with_noise(survey, kCases - 1, seed).points(sigma, sigma), {}, serial);
    return out;
  });
  Column column;
  for (const Judged& one : all) {
    for (std::size_t which = 0; which < kCases; ++which)
      column.papers[which].add(100.0 * (one.papers[which] / dimension - 1.0));
    if (!exact) continue;
    column.aware.add(one.aware, dimension);
  }
  return column;
}

using Columns = std::array<Column, kColumns>;

void print_papers_rows(const std::string& ground, const Columns& columns) {
  for (std::size_t which = 0; which < kCases; ++which)
    print_row(fmt::format("{}, {}", ground, kCaseNames[which]), kColumns, [&](std::size_t c) {
      const Errors& errors = columns[c].papers[which];
      return fmt::format("{:+.2f} ({:.2f}, {:+.1f})", errors.mean(), errors.sd(), errors.worst);
    });
}

/// The noise drawn again and again on one surface, which is what Table 1 shows, against other surfaces.
void print_redraws() {
  print_text(R"(
Standard deviation of D (not in %) at 30, 25, 20 dB, successive random additions: 100 noises on one surface, as in the
paper's table, and one noise each on 100 surfaces. A reproduction that redraws the noise alone would claim an accuracy
that no survey of one piece of ground has.

| | paper | lags | noise drawn again | other surfaces | ratio at 20 dB |
|---|---|---|---|---|---|)");
  struct Case {
    double dimension;
    const char* paper;
  };
  for (const auto& [dimension, paper] : {Case{2.1, ".0013, .0021, .0037"}, Case{2.8, ".0012, .0013, .0015"}})
    for (const int last_lag : {60, 128}) {
      const Survey one = survey_of(false, dimension, 0);
      struct Pair {
        std::array<double, kCases> noise{}, ground{};
      };
      const auto all = over_surfaces(surfaces(100), [&](int i) {
        const auto seed = 1000 + static_cast<std::uint64_t>(i);
        const Survey other = survey_of(false, dimension, seed);
        Pair found;
        for (std::size_t which = 1; which < kCases; ++which) {
          found.noise[which] = papers_estimate(with_noise(one, which, seed), last_lag);
          found.ground[which] = papers_estimate(with_noise(other, which, seed), last_lag);
        }
        return found;
      });
      std::string noise, ground;
      double ratio = 0.0;
      for (std::size_t which = 1; which < kCases; ++which) {
        Errors redrawn, other;
        for (const Pair& found : all) {
          redrawn.add(found.noise[which] - dimension);
          other.add(found.ground[which] - dimension);
        }
        const char* comma = which > 1 ? ", " : "";
        noise += fmt::format("{}{:.4f}", comma, redrawn.sd());
        ground += fmt::format("{}{:.3f}", comma, other.sd());
        ratio = other.sd() / redrawn.sd();
      }
      print_text(fmt::format("| D = {} | {} | 10 … {} | {} | {} | {:.0f} |", dimension, paper, last_lag, noise, ground,
                             ratio));
    }
}

void print_aware(const Columns& exact) {
  print_text("\nExact ground at 20 dB, an estimator that knows the noise (structure_dimension.hpp):\n");
  print_head("% of D", kDimensions);
  const auto percent = [&](double value, std::size_t c) { return 100.0 * value / kDimensions[c]; };
  print_row("mean", kColumns, [&](std::size_t c) { return with_sign(percent(exact[c].aware.mean(), c), 2); });
  print_row("target ±2", kColumns,
            [&](std::size_t c) { return at_most(std::abs(percent(exact[c].aware.mean(), c)), 2.0); });
  print_row("rms", kColumns, [&](std::size_t c) { return fixed(percent(exact[c].aware.rms(), c), 2); });
  print_row("target 4.5", kColumns, [&](std::size_t c) { return at_most(percent(exact[c].aware.rms(), c), 4.5); });
  print_row("95 % interval covers", kColumns, [&](std::size_t c) { return fixed(exact[c].aware.coverage(), 2); });
  print_row("paper's estimator, rms", kColumns, [&](std::size_t c) { return fixed(exact[c].papers.back().rms(), 2); });
}

}  // namespace

void paper_section() {
  print_text(R"(
## Table 1 of [AK96]

3277 random cells of 256 × 256, heights scaled to the standard deviation of x (73.9 cells), normal noise in x, y and z
at 30, 25 and 20 dB (2.3, 4.2, 7.4 cells), the paper's estimator: first absolute moment, annuli of half-width ½, lags
10 … 60, one unweighted line. The paper does not say its lags; with these its figures come back. 100 surfaces a case:
mean error in % of D (standard deviation over surfaces, worst); a mean's standard error is a tenth of the deviation.
)");
  Columns refined, exact;
  for (std::size_t c = 0; c < kColumns; ++c) {
    refined[c] = judge(false, kDimensions[c]);
    exact[c] = judge(true, kDimensions[c]);
  }
  print_head("", kDimensions);
  for (std::size_t which = 0; which < kCases; ++which)
    print_row(fmt::format("paper, {}", kCaseNames[which]), kColumns,
              [&](std::size_t c) { return with_sign(kPaper[which][c], 2); });
  print_papers_rows("successive random additions", refined);
  print_papers_rows("exact ground", exact);
  print_row("share of the generator in the clean error", kColumns, [&](std::size_t c) {
    const Errors &all = refined[c].papers[0], &own = exact[c].papers[0];
    const auto standard_error = [](const Errors& e) { return e.sd() / std::sqrt(static_cast<double>(e.count)); };
    if (std::abs(all.mean()) < 3.0 * standard_error(all)) return std::string("–");
    const double rest = own.mean() / all.mean();
    const double doubt = std::hypot(standard_error(own), rest * standard_error(all)) / std::abs(all.mean());
    return fmt::format("{:.0f} ± {:.0f} %", 100.0 * (1.0 - rest), 100.0 * doubt);
  });
  print_text(R"(
The share is 1 − (error on exact ground)/(error on the generator's) with its standard error, where the latter exceeds 3
of its own. Most
of the error at small D is the generator's: its surfaces are rougher than their nominal D says (see docs/fractal.md,
Generators).)");
  print_redraws();
  print_aware(exact);
}

}  // namespace scree::bench
