// The conditional method on large grids: coverage with a torus hardly larger than the window, time, memory.

#include <array>
#include <fstream>
#include <malloc.h>
#include <sstream>

#include "core/random.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

/// A line of /proc/self/status, bytes.
double process_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return 1024.0 * std::stod(line.substr(key.size() + 1));
  return NAN;
}

struct Run {
  PredictionScore score;
  double seconds = 0.0, bytes = 0.0, stated = 0.0;
  int cycles = 0;
};

/// Ground of side 1024, mirrored to and fro where the grid is larger: continuous, and of the law but for the seams.
Run run(double dimension, int side) {
  constexpr int kTile = 1024;
  const FractalLaw law{dimension, 1.0};
  const Grid<float> tile = *fbm_surface(law, kTile, kTile, 1.0, 1);
  const auto truth = [&](int r, int c) {
    const auto fold = [](int i) { return i / kTile % 2 == 0 ? i % kTile : kTile - 1 - i % kTile; };
    return tile(fold(r), fold(c));
  };
  malloc_trim(0);
  const double before = process_bytes("VmRSS:");
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts here
  CellSamples samples{Grid<float>(side, side, NAN), Grid<float>(side, side, NAN), Grid<std::uint16_t>(side, side, 0)};
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      const auto words = random_words(3, 5, c, r);
      if (to_uniform(words[0]) >= 0.05) continue;
      samples.height_m(r, c) = truth(r, c) + static_cast<float>(std::sqrt(1e-3) * random_normals(3, 6, c, r)[0]);
      samples.variance_m2(r, c) = 1e-3F;
      ++samples.cells;
    }
  const SurfaceRequest request{{side, side, 1.0}, {law, {}, {}}, 1, 7, {}, {}};
  Run result;
  SerialExecutor serial;
  SurfaceEstimate out;
  result.seconds = 1e-3 * timed([&] { out = *reconstruct_conditional(samples, request, {}, serial); }).cpu_ms;
  result.bytes = process_bytes("VmHWM:") - before;
  result.stated = static_cast<double>(conditional_memory_bytes(side, side, false));
  result.cycles = out.iterations;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c)
      if (std::isnan(samples.height_m(r, c)))
        result.score.add(static_cast<double>(truth(r, c) - out.mean_m(r, c)), static_cast<double>(out.sd_m(r, c)));
  return result;
}

}  // namespace

void large_section() {
  print_text(R"(
## Large grids

Mean and standard deviation from 8 fields, 5 % of the cells measured, one core; ground of 1024² mirrored to and fro. The
torus of the residual fields is exact up to 2048 cells a side and then an eighth larger than the grid. Memory: peak of
the process less what it held before, beside what `conditional_memory_bytes` states.

| D, side | covers (.895 … .905) | RMSE | s | ns a cell | bytes a cell | stated |
|---|---|---|---|---|---|---|)");
  for (const auto& [dimension, side] : {std::pair{2.5, 512},
                                        {2.2, 1024},
                                        {2.5, 1024},
                                        {2.8, 1024},
                                        {2.2, 2048},
                                        {2.5, 2048},
                                        {2.8, 2048},
                                        {2.5, 8192}}) {
    if (quick && side > 1024) continue;
    const Run one = run(dimension, side);
    const double cells = static_cast<double>(side) * side;
    print_row(fmt::format("{:g}, {}", dimension, side), 6, [&](std::size_t i) {
      return std::array{fixed(one.score.coverage(), 4) + " " + within(one.score.coverage(), 0.895, 0.905),
                        fixed(one.score.rmse(), 3),
                        fixed(one.seconds, 1),
                        fixed(1e9 * one.seconds / cells, 0),
                        fixed(one.bytes / cells, 0),
                        fixed(one.stated / cells, 0)}[i];
    });
  }
}

}  // namespace scree::bench
