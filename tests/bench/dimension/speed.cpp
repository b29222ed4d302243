// Times of one run: pairs, one D, maps of D.

#include <array>

#include "fractal/dimension_map.hpp"
#include "fractal/vecchia.hpp"
#include "fractal/vecchia_neighbours.hpp"
#include "fractal/vecchia_points.hpp"
#include "tests/bench/dimension/timing.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

void likelihood() {
  print_text(R"(
| one D with interval, one core, all passes | clean | target 3 | noise .3 known | target 8 | noise estimated | of which neighbours |
|---|---|---|---|---|---|---|)");
  for (const std::size_t count : {std::size_t{3277}, std::size_t{10000}, std::size_t{65536}}) {
    const Survey clean = scattered(count), noisy = scattered(count, 0.3);
    SurveyPoints unknown = noisy.points();
    unknown.noise_unknown = true;
    const auto call = [](const SurveyPoints& points) {
      return [points] {
        if (!estimate_dimension_vecchia(points)) std::exit(70);
      };
    };
    const VecchiaPoints prepared = *prepare_points(clean.points());
    const auto neighbours = [&] {
      if (nearest_predecessors(prepared.points).empty()) std::exit(70);
    };
    const auto times = times_of({call(clean.points()), call(noisy.points(0.3)), call(unknown), neighbours});
    const auto us = [&](std::size_t i) { return 1e3 * times[i].cpu_ms / static_cast<double>(count); };
    print_text(fmt::format("| N = {}, µs a point | {:.2f} | {} | {:.2f} | {} | {:.2f} | {:.2f} |", count, us(0),
                           at_most(us(0), 3.0), us(1), at_most(us(1), 8.0), us(2), us(3)));
    std::fflush(stdout);
  }
}

void map_of_cells() {
  print_text("\n| map of D, one core, one radius (10), 20 % empty | CPU ms | target | |\n|---|---|---|---|");
  for (const int side : {200, 400})
    for (const double noise : {0.0, 0.3}) {
      const FractalLaw law{2.4, 0.1};
      const double sigma = noise * law.rms_change_m(0.1);
      Grid<float> height = *fbm_surface(law, side, side, 0.1, 1);
      for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c) {
          height(r, c) += static_cast<float>(sigma * random_normals(1, 77, c, r)[0]);
          if (to_uniform(random_words(1, 78, c, r)[0]) < 0.2) height(r, c) = NAN;
        }
      const Grid<float> variance(side, side, static_cast<float>(sigma * sigma));
      const Grid<std::uint16_t> hits(side, side, 0);
      DimensionMapper mapper({});
      DimensionMap map;
      SerialExecutor serial;
      const auto call = [&] { mapper.update(height, variance, hits, serial, map); };
      call();  // tables are built once a process
      const Time time = times_of({call})[0];
      const bool judged = side == 200 && noise > 0.0;
      print_text(fmt::format("| {0} × {0}, {1} | {2:.1f} | {3} | {4} |", side, noise > 0.0 ? "noise known" : "clean",
                             time.cpu_ms, judged ? "10" : "", judged ? at_most(time.cpu_ms, 10.0) : ""));
      std::fflush(stdout);
    }
}

}  // namespace

void speed_section() {
  print_text(R"(
## Speed

The naive loop (every pair, double, root and round, counters A, B, C) is compiled beside with the same flags. CPU time
of the process, medians of up to 31 rounds; a second thread is judged by the wall, with turns taken. Ratios are what
to trust. The paper's computer took 5500 s for 19,600 points.)");
  for (const std::size_t count : {std::size_t{10000}, std::size_t{65536}})
    if (!quick || count == 10000) pair_speeds(count);
  likelihood();
  map_of_cells();
}

}  // namespace scree::bench
