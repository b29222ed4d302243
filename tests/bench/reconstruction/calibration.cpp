// Laws that are estimated: what errors of D and amplitude cost, and what innovation calibration brings back.

#include <array>

#include "core/random.hpp"
#include "fractal/reconstruction/innovation_calibration.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/bench/reconstruction/varying_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr int kFields = 128, kGrounds = 8, kFrames = 5;
constexpr std::size_t kRealisations = 3;
constexpr double kShare = 0.03;  // of the cells, measured by a frame

constexpr std::array kCases = {
    VaryingCase{"two, uniform", Layout::halves, kSand, kRubble, false},
    VaryingCase{"rev, holes", Layout::halves, {2.6, 0.3}, {2.15, 1.5}, true},
    VaryingCase{"patch, holes", Layout::patches, kSand, kRubble, true, 128, 3.1},
};

/// Standard normals whose correlation is a Gaussian of sd 8 cells: white noise under one of sd 8/√2, by its weights.
Grid<float> smooth_field(int side, std::uint64_t seed, std::uint64_t stream) {
  constexpr int kReach = 20;
  std::array<double, 2 * kReach + 1> g;
  double square = 0.0;
  for (int i = -kReach; i <= kReach; ++i) {
    g[static_cast<std::size_t>(i + kReach)] = std::exp(-i * i / 64.0);
    square += std::exp(-i * i / 32.0);
  }
  Grid<double> down(side, side + 2 * kReach, 0.0);
  for (int x = 0; x < down.columns(); ++x)
    for (int y = -kReach; y < side + kReach; ++y) {
      const double normal = random_normals(seed, stream, x, y)[0];
      for (int r = std::max(y - kReach, 0); r <= std::min(y + kReach, side - 1); ++r)
        down(r, x) += g[static_cast<std::size_t>(y - r + kReach)] * normal;
    }
  Grid<float> out(side, side);
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      double sum = 0.0;
      for (int i = 0; i <= 2 * kReach; ++i) sum += g[static_cast<std::size_t>(i)] * down(r, c + i);
      out(r, c) = static_cast<float>(sum / square);
    }
  return out;
}

/// Errors of sd .08 in D and 12.5 % in amplitude, independent of each other.
LawMap estimated(LawMap law, std::uint64_t seed) {
  const int side = law.dimension.rows();
  const Grid<float> d = smooth_field(side, seed, 41), a = smooth_field(side, seed, 42);
  for (std::size_t i = 0; i < d.size(); ++i) {
    law.dimension[i] = std::clamp(law.dimension[i] + 0.08F * d[i], 2.05F, 2.95F);
    law.amplitude_m[i] *= std::exp(0.125F * a[i]);
  }
  return law;
}

/// The frame that measures a cell: 0 … kFrames − 1, or one of those that never come.
int frame_of(std::uint64_t seed, int row, int column) {
  return static_cast<int>(to_uniform(random_words(seed, 43, column, row)[0]) / kShare);
}

/// The sd times √q after the first `frames` of the frames; `factor`: of the answer's sd over the predicted one.
VaryingAnswer calibrated(const VaryingScene& scene, VaryingAnswer answer, double factor, int frames,
                         std::uint64_t seed) {
  const int side = scene.side();
  InnovationCalibration calibration;
  SerialExecutor serial;
  for (int frame = 0; frame < frames; ++frame) {
    Grid<float> ratio(side, side, NAN);
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        if (scene.measured(r, c) || frame_of(seed, r, c) != frame) continue;
        const double noise = std::sqrt(VaryingScene::kNoise) * random_normals(seed, 44, c, r)[0];
        const double error = static_cast<double>(scene.truth(r, c) - answer.mean(r, c)) + noise;
        const double sd = static_cast<double>(answer.sd(r, c)) / factor;
        ratio(r, c) = static_cast<float>(error * error / (sd * sd + VaryingScene::kNoise));
      }
    calibration.update({{0, 0}, side, side}, ratio, serial);
  }
  if (frames > 0)
    for (std::size_t i = 0; i < answer.sd.size(); ++i) answer.sd[i] *= std::sqrt(calibration.factor()[i]);
  return answer;
}

constexpr std::array<const char*, 8> kNames = {
    "true law",
    "estimated law",
    "… calibrated, 3 % new cells",
    "… calibrated, 15 % new cells",
    "true law, sd map from 8 fields",
    "estimated law, sd map from 8 fields",
    "… calibrated, 3 % new cells",
    "… calibrated, 15 % new cells",
};
constexpr std::size_t kRows = kNames.size();
using Scores = std::array<ZoneScores, kRows>;

/// Cells that neither the data nor any of the frames measure.
void score_rest(const VaryingCase& c, const VaryingScene& scene, const VaryingAnswer& answer, std::uint64_t seed,
                ZoneScores& scores) {
  for (int r = 0; r < c.side; ++r)
    for (int x = 0; x < c.side; ++x)
      if (!scene.measured(r, x) && frame_of(seed, r, x) >= kFrames)
        scores[zone_of(c, r, x)].add(static_cast<double>(scene.truth(r, x) - answer.mean(r, x)),
                                     static_cast<double>(answer.sd(r, x)));
}

using Realisations = std::array<Scores, kRealisations>;

Realisations judge(const VaryingCase& c, int ground) {
  const std::uint64_t seed = kFirstSeed + static_cast<std::uint64_t>(ground);
  const VaryingScene scene(c, seed);
  Realisations scores;
  for (const bool map : {false, true}) {
    const int fields = map ? 8 : kFields;
    const double factor = map ? 1.0 : student_factor(kFields);
    const std::size_t first = map ? 4 : 0;
    const VaryingAnswer exact = by_draws(scene, scene.law, seed + 500, fields, map);
    for (std::size_t k = 0; k < kRealisations; ++k) {
      const std::uint64_t errors = seed + 1000 * (k + 1);
      score_rest(c, scene, exact, errors, scores[k][first]);
      const VaryingAnswer answer = by_draws(scene, estimated(scene.law, errors), seed + 500, fields, map);
      for (const auto& [row, frames] : {std::pair<std::size_t, int>{1, 0}, {2, 1}, {3, kFrames}})
        score_rest(c, scene, calibrated(scene, answer, factor, frames, errors), errors, scores[k][first + row]);
    }
  }
  return scores;
}

void table_of(const VaryingCase& c) {
  Realisations by_realisation;
  Scores total;
  for (const Realisations& one : over_surfaces(surfaces(kGrounds), [&](int i) { return judge(c, i); }))
    for (std::size_t k = 0; k < kRealisations; ++k)
      for (std::size_t row = 0; row < kRows; ++row)
        for (std::size_t z = 0; z < kZones; ++z) {
          by_realisation[k][row][z] += one[k][row][z];
          total[row][z] += one[k][row][z];
        }
  for (std::size_t row = 0; row < kRows; ++row)
    print_row(fmt::format("{}: {}", c.name, kNames[row]), kZones, [&](std::size_t z) {
      double low = 1.0, high = 0.0;
      for (const Scores& one : by_realisation) {
        low = std::min(low, one[row][z].coverage());
        high = std::max(high, one[row][z].coverage());
      }
      const double exact = total[row / 4 * 4][z].crps();
      const std::string crps = row % 4 == 0 ? fmt::format("{:.4f}", exact)
                                            : fmt::format("{:+.1f} %", 100.0 * (total[row][z].crps() / exact - 1.0));
      const std::string judged = row % 4 == 3 ? fmt::format(" {}", within(total[row][z].coverage(), 0.88, 0.925)) : "";
      return fmt::format("{} / {:.3f} ({:.3f} … {:.3f}){}", crps, total[row][z].coverage(), low, high, judged);
    });
}

/// Median of frames that roll by two cells, 3 % of the cells new.
double milliseconds(int side) {
  InnovationCalibration calibration;
  SerialExecutor serial;
  Grid<float> ratio(side, side, NAN);
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c)
      if (frame_of(1, r, c) == 0) ratio(r, c) = 1.0F;
  std::vector<double> times;
  for (int frame = 0; frame < 51; ++frame)
    times.push_back(timed([&] { calibration.update({{2 * frame, frame}, side, side}, ratio, serial); }).cpu_ms);
  return median(times);
}

}  // namespace

void calibration_section() {
  print_text(R"(
## Innovation calibration where the law is estimated

Ground of "D and amplitude of each cell", 8 surfaces. The law that the method is told errs by .08 in D and 12.5 % in
amplitude (sd; independent smooth fields whose correlation is a Gaussian of sd 8 cells), 3 realisations for each surface.
Then frames measure 3 % of the cells each, one or five of them, and the variance is multiplied by the factor of
innovation_calibration.hpp; mean and fields stay as they were. CRPS (or what it is more than with the true law) / share
inside the 90 % interval (lowest … highest of the realisations), of the cells that nothing measures; intervals from 128
residual fields, or from the sd map of 8. Target after 15 %: .88 … .925.
)");
  print_row("case: law", kZones, [](std::size_t z) { return std::array{"zone 1", "transition", "zone 2"}[z]; });
  std::puts("|---|---|---|---|");
  for (const VaryingCase& c : kCases) table_of(c);
  print_text(
      fmt::format("\nTime of a frame, window rolled by two cells, one core: {:.2f} ms at 200², {:.2f} ms at 256².",
                  milliseconds(200), milliseconds(256)));
}

}  // namespace scree::bench
