// Ground that shadows itself: the conditional method with and without the ceilings that rays set.

#include <array>

#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/scan_scene.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

struct Scan {
  double dimension, amplitude;
  int azimuths, elevations;
};
constexpr std::array kScans = {Scan{2.2, 0.4, 300, 100}, Scan{2.3, 0.5, 300, 100}, Scan{2.5, 1.0, 300, 100},
                               Scan{2.6, 1.5, 200, 64}};
constexpr std::array<double, kScans.size()> kColumns = {2.2, 2.3, 2.5, 2.6};
constexpr int kSide = 256;
constexpr std::array kBins = {1.0, 3.0, 6.0, 12.0, 24.0, 1e9};  // upper ends of the distances, cells

struct Score {
  PredictionScore all;
  std::array<PredictionScore, kBins.size()> bins;
  std::array<double, kBins.size()> error = {};

  void operator+=(const Score& other) {
    all += other.all;
    for (std::size_t b = 0; b < kBins.size(); ++b) {
      bins[b] += other.bins[b];
      error[b] += other.error[b];
    }
  }
};

Score judge(const ScanScene& scene, const Grid<float>& truth, bool ceilings, int fields) {
  SerialExecutor serial;
  SurfaceRequest request;
  request.grid = {kSide, kSide, 1.0};
  request.law.law = scene.law;
  request.draws = 0;
  ConditionalOptions options{.residual_fields = fields};
  if (ceilings) options.ceiling_m = scene.ceiling_m;
  const auto estimate = reconstruct_conditional(scene.samples, request, options, serial);
  const Grid<float> distance = distance_to_data(scene.samples.height_m);
  Score score;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto away = static_cast<double>(distance[i]);
    if (away == 0.0) continue;
    const double unit = scene.law.amplitude_m;
    const double error = static_cast<double>(truth[i] - estimate->mean_m[i]) / unit;
    const double sd = static_cast<double>(estimate->sd_m[i]) / unit;
    score.all.add(error, sd);
    std::size_t b = 0;
    while (away > kBins[b]) ++b;
    score.bins[b].add(error, sd);
    score.error[b] += error;
  }
  return score;
}

/// The same cells measured on ground that had no part in choosing them.
Score judge_independent(const ScanScene& scene, std::uint64_t seed) {
  ScanScene other = scene;
  other.truth = *fbm_surface(scene.law, kSide, kSide, 1.0, 1000 + seed);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      if (!std::isnan(scene.samples.height_m(r, c)))
        other.samples.height_m(r, c) = other.truth(r, c) + std::sqrt(scene.samples.variance_m2(r, c)) *
                                                               static_cast<float>(random_normals(seed, 71, c, r)[0]);
  return judge(other, other.truth, false, 8);
}

}  // namespace

void occlusion_section() {
  print_text(R"(
## Ground in its own shadow

256 × 256 cells of exact surfaces seen by a scanner 20 cells outside and 30 above their mean height; the change over one
cell is 0.4, 0.5, 1 and 1.5 cells. 4 scenes a column, outliers gated, 8 residual fields unless said. Cells without a
datum, in units of the change over one cell; bias: truth less mean.
)");
  std::array<std::array<Score, 4>, kScans.size()> sums;  // independent, plain, ceilings, ceilings with 32 fields
  std::array<double, kScans.size()> measured = {};
  for (std::size_t s = 0; s < kScans.size(); ++s)
    for (const auto& one : over_surfaces(surfaces(4), [&](int i) {
           const Scan& scan = kScans[s];
           const auto seed = static_cast<std::uint64_t>(i) + 21;
           const ScanScene scene(scan.dimension, scan.amplitude, kSide, scan.azimuths, scan.elevations, seed);
           return std::pair{std::array{judge_independent(scene, seed), judge(scene, scene.truth, false, 8),
                                       judge(scene, scene.truth, true, 8), judge(scene, scene.truth, true, 32)},
                            static_cast<double>(scene.samples.cells)};
         })) {
      for (std::size_t m = 0; m < 4; ++m) sums[s][m] += one.first[m];
      measured[s] += one.second / (kSide * kSide * surfaces(4));
    }
  print_head("", kColumns);
  print_row("measured, %", kScans.size(), [&](std::size_t s) { return fixed(100.0 * measured[s], 1); });
  constexpr std::array kNames = {"same cells of other ground", "plain", "ceilings", "ceilings, 32 fields"};
  const auto row = [&](const std::string& name, std::size_t m, auto cell) {
    print_row(fmt::format("{}, {}", name, kNames[m]), kScans.size(), [&](std::size_t s) { return cell(sums[s][m]); });
  };
  for (std::size_t m = 0; m < 4; ++m) row("RMSE", m, [](const Score& s) { return fixed(s.all.rmse(), 3); });
  for (std::size_t m = 0; m < 4; ++m) row("CRPS", m, [](const Score& s) { return fixed(s.all.crps(), 4); });
  print_row("CRPS, ceilings/plain; target ≤ .9", kScans.size(), [&](std::size_t s) {
    const double ratio = sums[s][2].all.crps() / sums[s][1].all.crps();
    return fmt::format("{:.3f}, {}", ratio, at_most(ratio, 0.9));
  });
  for (std::size_t m = 0; m < 4; ++m)
    row("90 % interval covers", m, [](const Score& s) { return fixed(s.all.coverage(), 3); });
  print_text("\nAll columns together, by the distance to the nearest datum (RMSE/coverage/bias).\n");
  print_text("| distance, cells | same cells of other ground | plain | ceilings |\n|---|---|---|---|");
  for (std::size_t b = 0; b < kBins.size(); ++b) {
    const std::string name = b + 1 < kBins.size() ? fmt::format("≤ {:g}", kBins[b]) : std::string("more");
    print_row(name, 3, [&](std::size_t m) {
      PredictionScore score;
      double error = 0.0;
      for (const auto& scan : sums) {
        score += scan[m].bins[b];
        error += scan[m].error[b];
      }
      return fmt::format("{:.2f}/{:.3f}/{:+.2f}", score.rmse(), score.coverage(), error / score.cells);
    });
  }
  const ScanScene scene(kScans[1].dimension, kScans[1].amplitude, kSide, kScans[1].azimuths, kScans[1].elevations, 21);
  const auto times =
      times_of({[&] { judge(scene, scene.truth, false, 8); }, [&] { judge(scene, scene.truth, true, 8); }});
  print_text(
      fmt::format("\nTime of gate, mean, sd and 8 fields at D = 2.3, one core: {:.0f} ms plain, {:.0f} ms with "
                  "ceilings.",
                  times[0].cpu_ms, times[1].cpu_ms));
}

}  // namespace scree::bench
