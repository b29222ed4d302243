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
    for (const Judgement& one : over_surfaces(surfaces(10), [&](int i) {
           return judge_scattered(scene_of(kDimensions[d], static_cast<std::uint64_t>(i)), method);
         }))
      columns[d] += one;
  print_judgement_rows(name, columns);
}

/// µs CPU of an insertion, after `count` of them in all, from 1000 samples.
double insertion_us(std::int64_t count, BarycentreLaw law, int realisations) {
  SurfaceRequest request;
  request.grid = {1024, 1024, 0.1};
  request.law.law = {2.5, 1.0};
  HeightSamples samples;
  for (int i = 0; i < 1000; ++i) {
    const auto words = random_words(31, 1, i, 0);
    samples.x_m.push_back(102.4 * to_uniform(words[0]));
    samples.y_m.push_back(102.4 * to_uniform(words[1]));
    samples.z_m.push_back(to_uniform(words[2]));
    samples.variance_m2.push_back(0.0);
  }
  const BarycentreOptions chosen = options(law);
  BarycentreRefinement refinement(*triangulate(samples, request), request, chosen, realisations);
  const Time time = timed([&] {
    if (refinement.refine(count) != count) print_text("insertions missing");
  });
  return 1e3 * time.cpu_ms / static_cast<double>(count);
}

void growth_table() {
  print_text(R"(
Growth: 1000 samples, then N insertions at barycentres; µs of CPU an insertion, which linear growth keeps constant.

| insertions | published, 1 realisation | published, 8 | exact variance, 8 | conditional, 8 | neighbours, 8 |
|---|---|---|---|---|---|)");
  for (const std::int64_t count : {10000, 30000, 100000, 300000, 1000000}) {
    std::string line = fmt::format("| {} |", count);
    line += fmt::format(" {:.2f} |", insertion_us(count, BarycentreLaw::published, 1));
    for (const BarycentreLaw law : {BarycentreLaw::published, BarycentreLaw::exact_variance, BarycentreLaw::conditional,
                                    BarycentreLaw::neighbours})
      line += fmt::format(" {:.2f} |", insertion_us(count, law, 8));
    print_text(line);
  }
}

}  // namespace

void barycentre_section() {
  print_text(R"(
## Barycentres of Delaunay triangles

Exact surfaces, the 256 × 256 cells in the middle of a larger one, 5 % of them samples, 10 a D; 8 realisations each, one
point for each cell. Errors in units of the change over one cell, of the cells without a sample.
)");
  print_head("", kDimensions);
  table("published", options(BarycentreLaw::published));
  table("exact variance", options(BarycentreLaw::exact_variance));
  table("conditional", options(BarycentreLaw::conditional));
  table("neighbours", options(BarycentreLaw::neighbours));
  table("conditional, then cell centres", options(BarycentreLaw::conditional, true));
  table("**neighbours, then cell centres**", corrected_barycentre());
  table("neighbours, cell centres alone", options(BarycentreLaw::neighbours, true, 0));
  growth_table();
}

}  // namespace scree::bench
