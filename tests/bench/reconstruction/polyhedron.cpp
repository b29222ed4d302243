// The experiment of [XZ00], with the figures it left out.

#include "fractal/reconstruction/polyhedron.hpp"

#include <array>

#include "fractal/vecchia.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/bench/reconstruction/scattered_truth.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
constexpr int kSide = 256;

/// 16 of each 10 × 10 cells stay, at random: ranks of the cells in the order of their random words.
std::function<bool(int, int)> sixteen_of_a_hundred(std::uint64_t seed) {
  return [seed](int row, int column) {
    const auto word = [seed](int r, int c) { return random_words(seed, 21, c, r)[0]; };
    const std::uint32_t own = word(row, column);
    int before = 0;
    for (int r = row / 10 * 10; r < row / 10 * 10 + 10; ++r)
      for (int c = column / 10 * 10; c < column / 10 * 10 + 10; ++c) before += word(r, c) < own;
    return before < 16;
  };
}
std::function<bool(int, int)> five_percent(std::uint64_t seed) {
  return [seed](int row, int column) { return to_uniform(random_words(seed, 22, column, row)[0]) < 0.05; };
}

ScatteredMethod polyhedron(int iterations) {
  return [iterations](const HeightSamples& samples, const SurfaceRequest& request) {
    SerialExecutor serial;
    return reconstruct_polyhedron(samples, request, {iterations, 0.0}, serial);
  };
}

struct Run {
  Judgement judgement;
  double dimension_error = 0.0;
};

Run run(double dimension, std::uint64_t seed, bool theirs) {
  const ScatteredTruth scene(dimension, kSide, seed, theirs ? sixteen_of_a_hundred(seed) : five_percent(seed));
  if (!theirs) return {judge_scattered(scene, polyhedron(0)), 0.0};
  const auto found =
      estimate_dimension_vecchia({.x_m = scene.samples.x_m, .y_m = scene.samples.y_m, .z_m = scene.samples.z_m});
  const FractalLaw law{found->dimension, found->amplitude_m};
  return {judge_scattered(scene, polyhedron(3), &law), found->dimension - dimension};
}

void table(const std::string& name, bool theirs) {
  std::vector<JudgementColumn> columns(kDimensions.size());
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const Run& one : over_surfaces(
             surfaces(10), [&](int i) { return run(kDimensions[d], static_cast<std::uint64_t>(i), theirs); })) {
      columns[d] += one.judgement;
      columns[d].dimension.add(one.dimension_error);
    }
  print_head(name, kDimensions);
  print_judgement_rows("polyhedron", columns);
  if (theirs)
    print_row("D found from the samples less D: mean ± sd", columns.size(), [&](std::size_t c) {
      return with_sign(columns[c].dimension.mean(), 3) + " ± " + fixed(columns[c].dimension.sd(), 3);
    });
}

}  // namespace

void polyhedron_section() {
  print_text(R"(
## The polyhedron of Xiao and Zhou

Exact surfaces, the 256 × 256 cells in the middle of a larger one, 10 a D; 8 realisations each. Errors in units of the
change over one cell, of the cells without a sample. D^ as above.

Their experiment: 84 of each 10 × 10 cells removed, D and amplitude found from the rest, three iterations:
)");
  table("16 % kept", true);
  print_text("\n5 % at random, the law given, iterations until no edge is as long as a cell:\n");
  table("5 % kept", false);
}

}  // namespace scree::bench
