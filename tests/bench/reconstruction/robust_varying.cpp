// Outliers, cliffs and shadows where the law varies over the map.

#include <array>

#include "fractal/reconstruction/outlier_gate.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "tests/bench/reconstruction/modulated_truth.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/scan_scene.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr int kSide = 128;
constexpr std::array<std::string_view, 2> kZones = {"D 2.15, change .3", "D 2.6, change 1.5"};

int zone_of(int column) {
  return column < kSide / 2 ? 0 : 1;
}

LawMap two_laws() {
  LawMap law{{2.375, std::sqrt(0.3 * 1.5)}, Grid<float>(kSide, kSide), Grid<float>(kSide, kSide)};
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double share = 0.5 + 0.5 * std::erf((c - 0.5 * (kSide - 1)) / 8.8);
      law.dimension(r, c) = static_cast<float>(2.15 + 0.45 * share);
      law.amplitude_m(r, c) = static_cast<float>(0.3 * std::pow(5.0, share));
    }
  return law;
}

/// 5 % of the cells, noise variance 1e-3 of the squared local change.
CellSamples sampled(const Grid<float>& truth, const LawMap& law, std::uint64_t seed) {
  CellSamples samples{Grid<float>(kSide, kSide, NAN), Grid<float>(kSide, kSide, NAN),
                      Grid<std::uint16_t>(kSide, kSide, 0)};
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      if (to_uniform(random_words(seed, 5, c, r)[0]) >= 0.05) continue;
      const double sigma = 0.0316 * static_cast<double>(law.amplitude_m(r, c));
      samples.height_m(r, c) = truth(r, c) + static_cast<float>(sigma * random_normals(seed, 6, c, r)[0]);
      samples.variance_m2(r, c) = static_cast<float>(sigma * sigma);
      samples.hits(r, c) = 1;
      ++samples.cells;
    }
  return samples;
}

SurfaceEstimate reconstruct(const CellSamples& samples, const LawMap& law, const ConditionalOptions& options) {
  SerialExecutor serial;
  SurfaceRequest request;
  request.grid = {kSide, kSide, 1.0};
  request.law = law;
  request.draws = 0;
  return *reconstruct_conditional(samples, request, options, serial);
}

struct Zone {
  PredictionScore first, second, third;
  double wrong = 0.0, found = 0.0, good = 0.0, lost = 0.0;

  void operator+=(const Zone& other) {
    first += other.first, second += other.second, third += other.third;
    wrong += other.wrong, found += other.found, good += other.good, lost += other.lost;
  }
};
using Zones = std::array<Zone, 2>;

PredictionScore score(const Grid<float>& truth, const SurfaceEstimate& estimate, const CellSamples& samples, int zone,
                      const Grid<std::uint8_t>* only = nullptr) {
  return score_prediction(truth, estimate.mean_m, estimate.sd_m, zone == 0 ? 0.3 : 1.5, [&](int r, int c) {
    return std::isnan(samples.height_m(r, c)) && zone_of(c) == zone && (only == nullptr || (*only)(r, c) != 0);
  });
}

/// first: gated, second: told, third: with all data.
Zones judge_outliers(std::uint64_t seed) {
  const LawMap law = two_laws();
  const Grid<float> truth = modulated_truth(law, seed);
  CellSamples samples = sampled(truth, law, seed), told = samples;
  Grid<std::uint8_t> wrong(kSide, kSide, 0);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const auto words = random_words(seed, 40, c, r);
      if (std::isnan(samples.height_m(r, c)) || to_uniform(words[0]) >= 0.03) continue;
      wrong(r, c) = 1;
      samples.height_m(r, c) +=
          law.amplitude_m(r, c) * static_cast<float>((words[2] & 1U ? 1 : -1) * (8 + 17 * to_uniform(words[1])));
      told.height_m(r, c) = told.variance_m2(r, c) = NAN;
      --told.cells;
    }
  const SurfaceEstimate gated = reconstruct(samples, law, {});
  const SurfaceEstimate known = reconstruct(told, law, {.gate_outliers = false});
  const SurfaceEstimate all = reconstruct(samples, law, {.gate_outliers = false});
  Zones zones;
  for (int z = 0; z < 2; ++z) {
    Zone& zone = zones[static_cast<std::size_t>(z)];
    zone.first = score(truth, gated, samples, z);
    zone.second = score(truth, known, samples, z);
    zone.third = score(truth, all, samples, z);
  }
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      if (std::isnan(samples.height_m(r, c))) continue;
      Zone& zone = zones[static_cast<std::size_t>(zone_of(c))];
      const double rejected = gated.rejected.empty() ? 0.0 : gated.rejected(r, c);
      (wrong(r, c) != 0 ? zone.wrong : zone.good) += 1.0;
      (wrong(r, c) != 0 ? zone.found : zone.lost) += rejected;
    }
  return zones;
}

/// A cliff of 17 along the middle row. first: plain near it, second: with breaks near it; third: with breaks away.
Zones judge_cliff(std::uint64_t seed) {
  const LawMap law = two_laws();
  Grid<float> truth = modulated_truth(law, seed);
  Grid<std::uint8_t> near(kSide, kSide, 0), away(kSide, kSide, 1);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      if (r >= kSide / 2) truth(r, c) += 17.0F;
      near(r, c) = std::abs(r - kSide / 2 + 0.5) < 4.6 ? 1 : 0;
      away(r, c) = near(r, c) != 0 ? 0 : 1;
    }
  const CellSamples samples = sampled(truth, law, seed);
  const SurfaceEstimate plain = reconstruct(samples, law, {.gate_outliers = false});
  const SurfaceEstimate broken = reconstruct(samples, law, {.gate_outliers = false, .break_edges = true});
  Zones zones;
  for (int z = 0; z < 2; ++z) {
    Zone& zone = zones[static_cast<std::size_t>(z)];
    zone.first = score(truth, plain, samples, z, &near);
    zone.second = score(truth, broken, samples, z, &near);
    zone.third = score(truth, broken, samples, z, &away);
  }
  return zones;
}

/// first: plain, second: ceilings.
Zones judge_shadow(std::uint64_t seed) {
  const LawMap law = two_laws();
  const ScanScene scene(law, modulated_truth(law, seed), 150, 80, seed);
  const SurfaceEstimate plain = reconstruct(scene.samples, law, {});
  const SurfaceEstimate below = reconstruct(scene.samples, law, {.ceiling_m = scene.ceiling_m});
  Zones zones;
  for (int z = 0; z < 2; ++z) {
    zones[static_cast<std::size_t>(z)].first = score(scene.truth, plain, scene.samples, z);
    zones[static_cast<std::size_t>(z)].second = score(scene.truth, below, scene.samples, z);
  }
  return zones;
}

Zones sum_of(int count, Zones (*judge)(std::uint64_t)) {
  Zones sums;
  for (const Zones& one : over_surfaces(surfaces(count), [&](int i) { return judge(static_cast<std::uint64_t>(i)); }))
    for (std::size_t z = 0; z < 2; ++z) sums[z] += one[z];
  return sums;
}

}  // namespace

void robust_varying_section() {
  print_text(R"(
## Outliers, cliffs and shadows where the law varies

128 × 128 cells, D 2.15 and a change of .3 over one cell on the left, 2.6 and 1.5 on the right, 16 cells of transition;
5 % measured, noise variance 1e-3 of the squared local change; the law is told cell by cell. By half, in units of its
change. Outliers: 3 %, 8 … 25 local changes, 16 scenes. Cliff: 17 high (57 and 11 changes) along the middle row, near:
within four cells, 8 scenes. Shadow: the scanner stands on the side of the smooth half, 8 scenes.

| outliers | RMSE with all data | gated | told which are wrong | found, % | good data lost, % |
|---|---|---|---|---|---|)");
  const Zones outliers = sum_of(16, judge_outliers);
  for (std::size_t z = 0; z < 2; ++z)
    print_text(fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.3f} |", kZones[z], outliers[z].third.rmse(),
                           outliers[z].first.rmse(), outliers[z].second.rmse(),
                           100.0 * outliers[z].found / outliers[z].wrong, 100.0 * outliers[z].lost / outliers[z].good));
  print_text(
      "\n| cliff | CRPS near, plain | breaks | covers near, plain | breaks | covers away, breaks "
      "|\n|---|---|---|---|---|---|");
  const Zones cliff = sum_of(8, judge_cliff);
  for (std::size_t z = 0; z < 2; ++z)
    print_text(fmt::format("| {} | {:.2f} | {:.2f} | {:.3f} | {:.3f} | {:.3f} |", kZones[z], cliff[z].first.crps(),
                           cliff[z].second.crps(), cliff[z].first.coverage(), cliff[z].second.coverage(),
                           cliff[z].third.coverage()));
  print_text("\n| shadow | CRPS, plain | ceilings | covers, plain | ceilings |\n|---|---|---|---|---|");
  const Zones shadow = sum_of(8, judge_shadow);
  for (std::size_t z = 0; z < 2; ++z)
    print_text(fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |", kZones[z], shadow[z].first.crps(),
                           shadow[z].second.crps(), shadow[z].first.coverage(), shadow[z].second.coverage()));
}

}  // namespace scree::bench
