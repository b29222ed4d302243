// The Delaunay-barycentre method: as published, corrected, and what an insertion costs.

#include "fractal/reconstruction/barycentre.hpp"

#include <array>

#include "fractal/reconstruction/barycentre_refinement.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/bench/reconstruction/scattered_truth.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};

ScatteredTruth scene_of(double dimension, std::uint64_t seed) {
  return {dimension, 256, seed,
          [seed](int row, int column) { return to_uniform(random_words(seed, 22, column, row)[0]) < 0.05; }};
}

BarycentreOptions options(BarycentreLaw law, bool centres = false, std::int64_t insertions = -1) {
  BarycentreOptions result;
  result.law = law;
  result.insert_cell_centres = centres;
  result.insertions = insertions;
  return result;
}

void table(const std::string& name, const BarycentreOptions& options) {
  std::vector<JudgementColumn> columns(kDimensions.size());
  const ScatteredMethod method = [&](const HeightSamples& samples, const SurfaceRequest& request) {
    SerialExecutor serial;
    return reconstruct_barycentre(samples, request, options, serial);
  };
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const Judgement& one : over_surfaces(surfaces(20), [&](int i) {
           return judge_scattered(scene_of(kDimensions[d], static_cast<std::uint64_t>(i)), method);
         }))
      columns[d] += one;
  print_judgement_rows(name, columns);
}

}  // namespace

void barycentre_section() {
  print_text(R"(
## Barycentres of Delaunay triangles

Exact surfaces, the 256 × 256 cells in the middle of a larger one, 5 % of them samples, 20 a D; 8 realisations each, one
point for each cell. Errors in units of the change over one cell, of the cells without a sample.
)");
  print_head("", kDimensions);
  table("published", options(BarycentreLaw::published));
  table("exact variance", options(BarycentreLaw::exact_variance));
  table("conditional", options(BarycentreLaw::conditional));
  table("conditional, then cell centres", options(BarycentreLaw::conditional, true));
  table("neighbours", options(BarycentreLaw::neighbours));
  table("neighbours, then cell centres", options(BarycentreLaw::neighbours, true));
  table("neighbours, cell centres alone", options(BarycentreLaw::neighbours, true, 0));
  table("cell centres alone", options(BarycentreLaw::conditional, true, 0));
}

}  // namespace scree::bench
