// What the fast routes to the structure function cost in the error of D, and what the weights of the line are worth.

#include <array>

#include "fractal/loglog_fit.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.1, 2.3, 2.5, 2.7, 2.8, 2.9};
constexpr int kPoints = 10000;
constexpr double kLags = 25.0;

struct Way {
  const char* name;
  bool geometric;
  PairOptions options;
  Moment moment;
  LineWeights weights;
};

constexpr std::array<Way, 9> kWays = {{
    {"all pairs, paper's line", false, {}, Moment::first_absolute, LineWeights::equal},
    {"all pairs, geometric annuli, equal weights", true, {}, Moment::first_absolute, LineWeights::equal},
    {"all pairs, geometric, weights 1/d²", true, {}, Moment::first_absolute, LineWeights::inverse_square},
    {"thinned, density 2, equal weights",
     true,
     {.route = PairRoute::thinned, .spacing_m = 1.0},
     Moment::first_absolute,
     LineWeights::equal},
    {"thinned, density 1, weights 1/d²",
     true,
     {.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 1.0},
     Moment::first_absolute,
     LineWeights::inverse_square},
    {"thinned, density 2, weights 1/d²",
     true,
     {.route = PairRoute::thinned, .spacing_m = 1.0},
     Moment::first_absolute,
     LineWeights::inverse_square},
    {"thinned, density 4, weights 1/d²",
     true,
     {.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 4.0},
     Moment::first_absolute,
     LineWeights::inverse_square},
    {"lattice, cell ½, weights 1/d²",
     true,
     {.route = PairRoute::lattice, .spacing_m = 0.5},
     Moment::second,
     LineWeights::inverse_square},
    {"lattice, cell 1, weights 1/d²",
     true,
     {.route = PairRoute::lattice, .spacing_m = 1.0},
     Moment::second,
     LineWeights::inverse_square},
}};

double dimension_by(const Way& way, const PointColumns& points) {
  SerialExecutor serial;
  const Annuli annuli = way.geometric ? geometric_annuli(1.0, std::sqrt(2.0), kLags) : uniform_annuli(1.0, kLags);
  const auto statistics = *structure_function(points, annuli, way.options, serial);
  constexpr double kAnything = 1e3;
  return log_log_dimension(log_log_points(statistics, way.moment, 10), way.moment, Segmentation::least_squares,
                           kAnything, way.weights)
      ->dimension;
}

}  // namespace

void pairs_section() {
  print_text(R"(
## Routes to the structure function: error of D

10,000 random cells of 256 × 256 of 60 exact surfaces, clean and level, lags 1 … 25 mean spacings, one line through
all annuli: bias, RMSE (standard error 9 %; the differences between rows are surer, the surfaces are the same). The
lattice routes move points to cell centres.
)");
  print_head("", kDimensions);
  std::array<std::array<Errors, kWays.size()>, kDimensions.size()> errors;
  for (std::size_t c = 0; c < errors.size(); ++c) {
    const auto all = over_surfaces(surfaces(60), [&](int i) {
      const PointColumns points = exact_survey(kDimensions[c], static_cast<std::uint64_t>(i), kPoints).columns();
      std::array<double, kWays.size()> found;
      for (std::size_t w = 0; w < kWays.size(); ++w) found[w] = dimension_by(kWays[w], points);
      return found;
    });
    for (const auto& one : all)
      for (std::size_t w = 0; w < kWays.size(); ++w) errors[c][w].add(one[w] - kDimensions[c]);
  }
  for (std::size_t w = 0; w < kWays.size(); ++w)
    print_row(kWays[w].name, errors.size(),
              [&](std::size_t c) { return with_sign(errors[c][w].mean(), 3) + ", " + fixed(errors[c][w].rms()); });
  constexpr std::size_t kAllPairs = 1, kThinned = 5;
  print_row("thinned (density 2, 1/d²) ≤ all pairs (equal weights), D ≤ 2.8", errors.size(), [&](std::size_t c) {
    return kDimensions[c] > 2.81 ? std::string("no target")
                                 : at_most(errors[c][kThinned].rms(), errors[c][kAllPairs].rms());
  });
}

}  // namespace scree::bench
