// One D for few scattered points, with and without known noise.

#include <array>

#include "fractal/fbm_points.hpp"
#include "fractal/vecchia.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.05, 2.2, 2.4, 2.6, 2.8, 2.9};
constexpr std::array kClean = {0.0, .095, .092, .082, .068, .060};  // targets for 100 points; 0: none
constexpr std::array kNoisy = {0.0, .14, .125, .11, .08, .07};
constexpr int kDraws = 20;  // surfaces a set of places

Errors judge(std::size_t points, double dimension, double noise, int count) {
  const auto sets = over_surfaces(count / kDraws, [&](int set) {
    Survey survey;
    const double side = std::sqrt(static_cast<double>(points));
    for (std::size_t i = 0; i < points; ++i) {
      const auto words = random_words(static_cast<std::uint64_t>(set), 10, static_cast<std::int32_t>(i), 0);
      survey.x.push_back(side * to_uniform(words[0]));
      survey.y.push_back(side * to_uniform(words[1]));
    }
    const auto truth = *FbmPoints::make({dimension, 1.0}, survey.x, survey.y);
    std::array<DimensionEstimate, kDraws> found;
    for (std::size_t draw = 0; draw < kDraws; ++draw) {
      const auto seed = static_cast<std::uint64_t>(set) * kDraws + draw;
      survey.z = truth.draw(seed);
      add_plane(survey, 0.5, 0.0);
      add_noise(survey, noise, 0.0, seed);
      found[draw] = *estimate_dimension_vecchia(survey.points(noise));
    }
    return found;
  });
  Errors errors;
  for (const auto& set : sets)
    for (const auto& estimate : set) errors.add(estimate, dimension);
  return errors;
}

void table(std::size_t points, double noise, int count) {
  std::array<Errors, kDimensions.size()> errors;
  for (std::size_t c = 0; c < errors.size(); ++c) errors[c] = judge(points, kDimensions[c], noise, surfaces(count));
  const std::string name = fmt::format("N = {}, {}", points, noise > 0.0 ? "noise .3 known" : "clean");
  print_row(name + ": bias, RMSE", errors.size(),
            [&](std::size_t c) { return with_sign(errors[c].mean(), 3) + ", " + fixed(errors[c].rms(), 3); });
  print_row("covers", errors.size(),
            [&](std::size_t c) { return fixed(errors[c].coverage(), 3) + errors[c].unknowns(); });
  if (points != 100) return;
  const auto& targets = noise > 0.0 ? kNoisy : kClean;
  print_row("RMSE target", errors.size(), [&](std::size_t c) {
    return targets[c] > 0.0 ? fmt::format("{:g}: {}", targets[c], at_most(errors[c].rms(), targets[c]))
                            : std::string("–");
  });
}

}  // namespace

void small_section() {
  print_text(R"(
## Few scattered points

Uniform places, new ones every 20 surfaces, slope .5 added, 1000 surfaces a case (N = 100, which has targets: 4000; N
= 1000: 200; standard error of an RMSE 2.2, 1.1, 5 %, of a coverage .007, .0035, .015); noise 30 % of the rms change
over the mean spacing.
)");
  print_head("Vecchia", kDimensions);
  for (const double noise : {0.0, 0.3}) {
    for (const std::size_t points : {50U, 100U, 200U}) table(points, noise, points == 100U ? 4000 : 1000);
    table(1000, noise, 200);
  }
}

}  // namespace scree::bench
