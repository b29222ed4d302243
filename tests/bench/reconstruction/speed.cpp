// Times of the conditional method's parts, each beside the solver as it is written down (plain_solver.hpp).

#include <array>

#include "core/random.hpp"
#include "fractal/reconstruction/cold_start.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/residual_tile.hpp"
#include "fractal/reconstruction/sd_map.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/plain_solver.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

/// One window with 5 % of its cells measured, and everything that solves it.
struct Setting {
  SparseScene scene;
  LawMap law;
  Conditioning problem;
  ResidualTiles tiles;
  PaddedField u, noise, b, x;
  BlendSolver solver;
  plain::BlendOperator plain_matrix;
  plain::BlendSolver plain_solver;
  int iterations = 0;

  Setting(double dimension, int side, bool varies = false)
      : scene(dimension, side, side, 0.05, 1), law{scene.law, {}, {}}, tiles(1, side + side / 2) {
    if (varies) {
      law.dimension = Grid<float>(side, side, static_cast<float>(dimension));
      law.amplitude_m = Grid<float>(side, side, static_cast<float>(kSceneAmplitudeM));
    }
    load();
    tiles.prepare(dimension);
    for (PaddedField* field : {&u, &noise, &b, &x}) field->resize(problem.shape().rows, problem.shape().columns);
  }
  void load() { problem.load(scene.height, scene.variance, law, {0, 0}, kSceneCellM); }

  void solve(double tolerance) { iterations = solver.solve(problem.matrix(), b, tolerance, 60, x).iterations; }
  void mean() {
    load();
    problem.mean_problem(scene.height, b);
    x.resize(x.rows(), x.columns());
    solve(problem.tolerance(0.05));
  }
  void residual_problem() {
    for (int r = 0; r < u.rows(); ++r) {
      tiles.surface_row(scene.law.dimension, 0, {0, r}, {0, 0}, u.columns(), u.row(r));
      tiles.noise_row(0, {0, r}, u.columns(), b.row(r));
    }
    problem.residual_problem(u, b);
  }
  void draw() {
    residual_problem();
    start_from_means(u, problem.spacing_cells(), x);
    solve(problem.cold_tolerance(0.05));
  }
  /// The same draw by plain loops, its levels set up too as for a mean.
  void plain_solve(bool set_up) {
    if (set_up) {
      PaddedField precision = x;
      for (int r = 0; r < x.rows(); ++r) std::copy_n(problem.precision(r), x.columns(), precision.row(r));
      const double spacing = std::sqrt(1.0 / 0.05);
      plain_matrix.set_up(problem.shape(),
                          blend_weights(scene.law.dimension, blend_wavenumber(scene.law.dimension, spacing)),
                          precision);
      problem.mean_problem(scene.height, b);
      x.resize(x.rows(), x.columns());
    } else {
      residual_problem();
      start_from_means(u, problem.spacing_cells(), x);
    }
    plain_solver.solve(plain_matrix, b, set_up ? problem.tolerance(0.05) : problem.cold_tolerance(0.05), 60, x);
  }
};

void cold() {
  constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
  print_text("\n256 × 256 cells, 5 % measured, cold, CPU time of one core:\n");
  print_head("", kDimensions);
  std::array<std::array<Time, 6>, kDimensions.size()> times;
  std::array<int, kDimensions.size()> cycles;
  for (std::size_t d = 0; d < kDimensions.size(); ++d) {
    Setting one(kDimensions[d], 256), varying(kDimensions[d], 256, true);
    one.plain_solve(true);
    const auto measured = times_of({[&] { one.mean(); }, [&] { one.draw(); }, [&] { one.plain_solve(true); },
                                    [&] { one.plain_solve(false); }, [&] { varying.mean(); }, [&] { varying.draw(); }});
    std::copy_n(measured.begin(), 6, times[d].begin());
    one.draw();
    cycles[d] = one.iterations;
  }
  const auto row = [&](const std::string& name, auto cell) { print_row(name, kDimensions.size(), cell); };
  const auto target = [&](std::size_t d) { return kDimensions[d] < 2.35 ? 2.2 : 1.5; };
  for (const auto& [name, which] : {std::pair{"mean, levels set up too", 0U}, {"draw", 1U}}) {
    row(fmt::format("{}, ms", name), [&](std::size_t d) { return fixed(times[d][which].cpu_ms, 2); });
    row("… target 1.5 (2.2 below D = 2.4)", [&](std::size_t d) { return at_most(times[d][which].cpu_ms, target(d)); });
    row("… by plain loops, ms", [&](std::size_t d) { return fixed(times[d][which + 2].cpu_ms, 2); });
    row("… ratio", [&](std::size_t d) { return fixed(times[d][which].cpu_ms / times[d][which + 2].cpu_ms, 2); });
  }
  row("cycles of the draw", [&](std::size_t d) { return std::to_string(cycles[d]); });
  row("mean, a law for each cell, ms", [&](std::size_t d) { return fixed(times[d][4].cpu_ms, 2); });
  row("draw, operator of each cell, ms", [&](std::size_t d) { return fixed(times[d][5].cpu_ms, 2); });
  row("… ratio to one law", [&](std::size_t d) { return fixed(times[d][5].cpu_ms / times[d][1].cpu_ms, 2); });
}

/// 256 × 256 cells roll by two a frame over ground of which `share` is measured anew in every frame.
struct Frames {
  static constexpr int kSide = 256, kTravel = 64;
  SparseScene world;
  LawMap law;
  ConditionalReconstructor reconstructor;
  SdMap map;
  Reconstruction out;
  Grid<float> height{kSide, kSide}, variance{kSide, kSide}, sd;
  int frame = 0;

  Frames(double dimension, bool varies)
      : world(dimension, kSide + kTravel, kSide + kTravel, 0.3, 1),
        law{world.law, {}, {}},
        reconstructor({.cell_m = kSceneCellM, .max_cells = kSide, .residual_fields = 8}) {
    if (varies) {
      law.dimension = Grid<float>(kSide, kSide, static_cast<float>(dimension));
      law.amplitude_m = Grid<float>(kSide, kSide, static_cast<float>(kSceneAmplitudeM));
    }
  }
  /// The data of the next frame; not part of the time.
  void advance() {
    ++frame;
    const int offset = 2 * frame % kTravel;
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const bool fresh = to_uniform(random_words(7, static_cast<std::uint64_t>(frame), c + offset, r)[0]) < 0.1;
        height(r, c) = world.height(r, c + offset) + (fresh ? static_cast<float>(0.5 * world.sigma) : 0.0F);
        variance(r, c) = world.variance(r, c + offset);
      }
  }
  void step() {
    SerialExecutor serial;
    reconstructor.reconstruct(height, variance, {{2 * frame % kTravel, 0}, kSide, kSide}, law, serial, out);
    map.estimate(out.mean_square_m2, 8, variance, law, kSceneCellM, serial, sd);
  }
};

void frames() {
  constexpr std::array kDimensions = {2.2, 2.3, 2.5, 2.7, 2.8};
  print_text(
      "\nA frame: window of 256 × 256 rolled by 2 cells, 30 % measured, a tenth of the cells measured anew; mean, draw "
      "and standard deviation from 8 fields, one core:\n");
  print_head("", kDimensions);
  std::array<std::array<std::string, kDimensions.size()>, 5> text;
  for (std::size_t d = 0; d < kDimensions.size(); ++d)
    for (const bool varies : {false, true}) {
      Frames frames(kDimensions[d], varies);
      std::vector<double> all, map;
      double cycles = 0.0;
      for (int i = 0; i < (quick ? 5 : 28); ++i) {
        frames.advance();
        const double ms = timed([&] { frames.step(); }).cpu_ms;
        SerialExecutor serial;
        const double sd_ms = timed([&] {
                               frames.map.estimate(frames.out.mean_square_m2, 8, frames.variance, frames.law,
                                                   kSceneCellM, serial, frames.sd);
                             }).cpu_ms;
        if (i < 2) continue;  // tiles, and the first cold frame
        all.push_back(ms);
        map.push_back(sd_ms);
        cycles += frames.out.iterations / 9.0;
      }
      const std::size_t first = varies ? 3 : 0;
      const double ms = median(all);
      text[first][d] = fixed(ms, 2) + " " + at_most(ms, 8.0);
      if (varies) {
        text[4][d] = fixed(cycles / static_cast<double>(all.size()), 1);
      } else {
        text[1][d] = fixed(median(map), 2);
        text[2][d] = fixed(cycles / static_cast<double>(all.size()), 1);
      }
    }
  constexpr std::array kNames = {"one law, ms; target 8", "… of it the sd map, ms", "… cycles a solve",
                                 "a law for each cell, ms; target 8", "… cycles a solve"};
  for (std::size_t i = 0; i < text.size(); ++i)
    print_row(kNames[i], kDimensions.size(), [&](std::size_t d) { return text[i][d]; });
}

void sizes() {
  constexpr std::array<double, 5> kSides = {256, 512, 1024, 2048, 4096};
  print_text("\nOne cold draw of D = 2.5 by size, 5 % measured, field given:\n");
  print_head("", kSides, "side ");
  std::array<double, kSides.size()> fused, plain, cycles;
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const int side = static_cast<int>(kSides[i]);
    Setting one(2.5, std::min(side, 512));
    // Larger windows repeat the data of 512 × 512: the solver does not know.
    if (side > 512) {
      SparseScene& s = one.scene;
      const Grid<float> height = s.height, variance = s.variance;
      s.height.assign(side, side, 0.0F);
      s.variance.assign(side, side, 0.0F);
      for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c) {
          s.height(r, c) = height(r % 512, c % 512);
          s.variance(r, c) = variance(r % 512, c % 512);
        }
      one.load();
      for (PaddedField* field : {&one.u, &one.noise, &one.b, &one.x}) field->resize(side, side);
    }
    one.plain_solve(true);
    one.residual_problem();
    const auto times = times_of({[&] {
                                   start_from_means(one.u, one.problem.spacing_cells(), one.x);
                                   one.solve(0.02);
                                 },
                                 [&] {
                                   start_from_means(one.u, one.problem.spacing_cells(), one.x);
                                   one.plain_solver.solve(one.plain_matrix, one.b, 0.02, 60, one.x);
                                 }});
    const double cells = kSides[i] * kSides[i];
    fused[i] = 1e6 * times[0].cpu_ms / cells;
    plain[i] = 1e6 * times[1].cpu_ms / cells;
    cycles[i] = one.iterations;
  }
  const auto row = [&](const std::string& name, auto cell) { print_row(name, kSides.size(), cell); };
  row("ns a cell", [&](std::size_t i) { return fixed(fused[i], 1); });
  row("over that of 256²; target 2.5",
      [&](std::size_t i) { return fixed(fused[i] / fused[0], 2) + " " + at_most(fused[i] / fused[0], 2.5); });
  row("by plain loops, ns a cell", [&](std::size_t i) { return fixed(plain[i], 1); });
  row("ratio", [&](std::size_t i) { return fixed(fused[i] / plain[i], 2); });
  row("cycles", [&](std::size_t i) { return fixed(cycles[i], 0); });
}

}  // namespace

void speed_section() {
  print_text("\n## Speed of the conditional method\n");
  cold();
  frames();
  sizes();
}

}  // namespace scree::bench
