// The structure function by every route against the naive double loop, compiled beside it with the same flags.
// docs/fractal.md quotes the table. Arguments: the numbers of points (default 10000 65536).

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/random.hpp"
#include "fractal/structure_function.hpp"
#include "fractal/surface.hpp"
#include "node/worker_pool.hpp"

namespace {

using namespace scree;
using namespace scree::fractal;

/// What a careful person writes first: root and round each pair, counters A, B and C.
std::vector<PairSums> naive(const PointColumns& points, int last_lag) {
  const std::vector<double> x(points.x_m.begin(), points.x_m.end()), y(points.y_m.begin(), points.y_m.end()),
      z(points.z_m.begin(), points.z_m.end());
  std::vector<PairSums> sums(static_cast<std::size_t>(last_lag) + 1);
  for (std::size_t i = 0; i < z.size(); ++i)
    for (std::size_t j = i + 1; j < z.size(); ++j) {
      const double dx = x[j] - x[i], dy = y[j] - y[i];
      const int lag = static_cast<int>(std::sqrt(dx * dx + dy * dy) + 0.5);
      if (lag < 1 || lag > last_lag) continue;
      const double dz = z[j] - z[i];
      auto& sum = sums[static_cast<std::size_t>(lag)];
      sum.count += 1.0;
      sum.abs_m += std::abs(dz);
      sum.square_m2 += dz * dz;
    }
  return sums;
}

/// N points at random places of a √N × √N field, heights of an exact surface's nearest lattice point.
PointColumns scattered(int count) {
  const double side = std::sqrt(count);
  const int cells = static_cast<int>(std::ceil(side)) + 1;
  const auto surface = fbm_surface({2.5, 1.0}, cells, cells, 1.0, 3);
  PointColumns points;
  for (int i = 0; i < count; ++i) {
    const auto words = random_words(5, 5, i, 0);
    const double x = side * to_uniform(words[0]), y = side * to_uniform(words[1]);
    points.push_back(static_cast<float>(x), static_cast<float>(y),
                     (*surface)(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x))));
  }
  return points;
}

struct Time {
  double cpu_ms, wall_ms;
};

/// Median over as many calls as fit in about two seconds, at most 31.
Time time_of(const std::function<void()>& call) {
  std::vector<double> cpu, wall;
  double total = 0.0;
  do {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    call();
    cpu.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    wall.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    total += cpu.back();
  } while (total < 2000.0 && cpu.size() < 31);
  const auto median = [](std::vector<double>& times) {
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
  };
  return {median(cpu), median(wall)};
}

void report(int count) {
  const PointColumns points = scattered(count);
  const int last_lag = static_cast<int>(std::sqrt(count) / 4.0);
  const Annuli annuli = uniform_annuli(1.0, last_lag), geometric = geometric_annuli(1.0, std::sqrt(2.0), last_lag);
  SerialExecutor serial;
  node::WorkerPool pool(2);
  const std::jthread worker([&](const std::stop_token& stop) { pool.work(stop); });

  std::vector<PairSums> check;
  const Time base = time_of([&] { check = naive(points, last_lag); });
  std::printf("\n| N = %d, lags 1..%d | CPU | wall | naive CPU / CPU | pairs looked at |\n|---|---|---|---|---|\n",
              count, last_lag);
  std::printf("| naive double, sqrt and round | %.1f ms | %.1f ms | 1 | %.3g |\n", base.cpu_ms, base.wall_ms,
              0.5 * count * (count - 1.0));
  const auto row = [&](const std::string& name, const Annuli& lags, const PairOptions& options, Executor& executor) {
    Result<StructureFunction> result = Error{};
    const Time time = time_of([&] { result = structure_function(points, lags, options, executor); });
    if (!result) std::exit(70);
    std::printf("| %s | %.2f ms | %.2f ms | %.1f | %.3g |\n", name.c_str(), time.cpu_ms, time.wall_ms,
                base.cpu_ms / time.cpu_ms, static_cast<double>(result->pairs_visited));
    std::fflush(stdout);
  };
  row("all pairs, vectorised", annuli, {.route = PairRoute::all_pairs}, serial);
  row("same, two threads", annuli, {.route = PairRoute::all_pairs}, pool);
  row("same, geometric annuli", geometric, {.route = PairRoute::all_pairs}, serial);
  row("near pairs (cell list)", annuli, {.route = PairRoute::near_pairs}, serial);
  row("thinned, density 1", annuli, {.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 1.0}, serial);
  row("thinned, density 2", annuli, {.route = PairRoute::thinned, .spacing_m = 1.0}, serial);
  row("thinned, density 2, geometric", geometric, {.route = PairRoute::thinned, .spacing_m = 1.0}, serial);
  row("thinned, density 4", annuli, {.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 4.0}, serial);
  row("Fourier, cell 1 spacing", annuli, {.route = PairRoute::lattice, .spacing_m = 1.0}, serial);
  row("Fourier, cell 1/2 spacing", annuli, {.route = PairRoute::lattice, .spacing_m = 0.5}, serial);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> counts;
  for (int i = 1; i < argc; ++i)
    if (const int count = std::atoi(argv[i]); count > 1) counts.push_back(count);
  if (counts.empty()) counts = {10000, 65536};
  for (const int count : counts) report(count);
}
