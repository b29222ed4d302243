// The paper's sampler: how many sweeps it needs, and its time against the conditional method.

#include <array>

#include "fractal/reconstruction/szeliski.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/method_scores.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
constexpr std::array kSweeps = {1, 2, 3, 5, 10, 20, 50, 200};  // the last: converged
constexpr int kPapersSweeps = 50, kRuns = 8;

Result<SurfaceEstimate> sample(const SparseScene& scene, int sweeps, bool tuned, std::uint64_t seed,
                               const std::function<void(int, const Grid<float>&)>& on_draw = {}) {
  SerialExecutor serial;
  SurfaceRequest request = request_for(scene, kRuns);
  request.seed = seed;
  request.on_draw = on_draw;
  return reconstruct_szeliski(cells_of(scene), request, {{}, sweeps, tuned}, serial);
}

/// Of all sweeps on one surface; draws of the scalar and of the tuned sampler have one law, so the tuned one serves.
using Scores = std::array<MethodScore, kSweeps.size()>;

Scores judge(double dimension, std::uint64_t seed) {
  const SparseScene scene(dimension, kMethodSide, kMethodSide, 0.05, seed);
  Scores scores;
  for (std::size_t s = 0; s < kSweeps.size(); ++s) {
    MethodResult result;
    result.estimate =
        *sample(scene, kSweeps[s], true, seed + 1, [&](int, const Grid<float>& draw_m) { result.draw_m = draw_m; });
    scores[s].add(scene, result, kEightDraws);
  }
  return scores;
}

struct Column {
  Scores scores;
  std::size_t adequate = 0;  // index of the fewest sweeps within 2 % of the converged RMSE of the mean
  double conditional_ms = 0.0, fifty_ms = 0.0, fifty_tuned_ms = 0.0, adequate_ms = 0.0, adequate_tuned_ms = 0.0;
};

void find_adequate(Column& column) {
  const double converged = column.scores.back().rmse();
  while (column.scores[column.adequate].rmse() > 1.02 * converged) ++column.adequate;
}

/// Medians of CPU ms of one mean or draw, all calls in turn.
void time_column(double dimension, Column& column) {
  const SparseScene scene(dimension, kMethodSide, kMethodSide, 0.05, 1);
  SerialExecutor serial;
  ConditionalReconstructor conditional({.cell_m = kSceneCellM, .max_cells = kMethodSide});
  Reconstruction out;
  int place = 0;
  const auto cold = [&] {  // far away each time: no warm start
    conditional.reconstruct(scene.height, scene.variance, {{100000 * place++, 0}, kMethodSide, kMethodSide}, scene.law,
                            serial, out);
  };
  cold();  // makes the tiles
  const auto papers = [&](int sweeps, bool tuned) {
    return [&, sweeps, tuned] { (void)sample(scene, sweeps, tuned, 1); };
  };
  const int fewest = kSweeps[column.adequate];
  const auto many = [&] {
    for (int i = 0; i < 8; ++i) cold();
  };
  const std::vector<Time> times = times_of(
      {many, papers(kPapersSweeps, false), papers(kPapersSweeps, true), papers(fewest, false), papers(fewest, true)});
  column.conditional_ms = times[0].cpu_ms / 16.0;  // 8 means and 8 draws
  column.fifty_ms = times[1].cpu_ms / (kRuns + 1.0);
  column.fifty_tuned_ms = times[2].cpu_ms / (kRuns + 1.0);
  column.adequate_ms = times[3].cpu_ms / (kRuns + 1.0);
  column.adequate_tuned_ms = times[4].cpu_ms / (kRuns + 1.0);
}

using Columns = std::array<Column, kDimensions.size()>;

void print_quality(const Columns& columns) {
  print_head("RMSE mean / RMSE draw / D^ − D*", kDimensions);
  for (std::size_t s = 0; s < kSweeps.size(); ++s)
    print_row(fmt::format("{} sweeps a level", kSweeps[s]), columns.size(), [&](std::size_t c) {
      const MethodScore& score = columns[c].scores[s];
      return fmt::format("{:.3f} / {:.3f} / {:+.3f}", score.rmse(), score.draw_rmse(), score.roughness.mean());
    });
  print_row("fewest within 2 % of the converged RMSE of the mean", columns.size(),
            [&](std::size_t c) { return std::to_string(kSweeps[columns[c].adequate]); });
}

void print_times(const Columns& columns) {
  print_text(
      "\nCPU time of one mean or draw, medians of calls in turn, and how many times the conditional method's:\n");
  print_head("ms (ratio)", kDimensions);
  const auto row = [&](const std::string& name, double Column::*time) {
    print_row(name, columns.size(), [&](std::size_t c) {
      return fmt::format("{:.2f} ({:.1f})", columns[c].*time, columns[c].*time / columns[c].conditional_ms);
    });
  };
  row("conditional, cold", &Column::conditional_ms);
  row("50 sweeps", &Column::fifty_ms);
  print_row("… target ≥ 40 ×", columns.size(),
            [&](std::size_t c) { return at_least(columns[c].fifty_ms / columns[c].conditional_ms, 40.0); });
  row("fewest adequate", &Column::adequate_ms);
  print_row("… target ≥ 2 ×", columns.size(),
            [&](std::size_t c) { return at_least(columns[c].adequate_ms / columns[c].conditional_ms, 2.0); });
  row("50 sweeps, tuned", &Column::fifty_tuned_ms);
  row("fewest adequate, tuned", &Column::adequate_tuned_ms);
}

}  // namespace

void sampler_section() {
  const int count = surfaces(4);
  print_text(fmt::format(R"(
## The paper's sampler against the conditional method

Closed-form temperature, 256 × 256 cells, 5 % measured, {} surfaces a D, judged as above. "Tuned" is the same sampler
with rows as vectors (gibbs_rows.hpp). What does not go away with more sweeps is that coarse levels are frozen before
the fine data are seen: the draws are not of the posterior.
)",
                         count));
  Columns columns;
  for (std::size_t d = 0; d < kDimensions.size(); ++d) {
    for (const Scores& one :
         over_surfaces(count, [&](int i) { return judge(kDimensions[d], static_cast<std::uint64_t>(i)); }))
      for (std::size_t s = 0; s < kSweeps.size(); ++s) columns[d].scores[s] += one[s];
    find_adequate(columns[d]);
    time_column(kDimensions[d], columns[d]);
  }
  print_quality(columns);
  print_times(columns);
}

}  // namespace scree::bench
