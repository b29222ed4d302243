// Pairs by the vectorised kernel: all of them, those within reach, and a sample that thins out with distance.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.hpp"
#include "fractal/pair_kernel.hpp"
#include "fractal/pair_routes.hpp"
#include "fractal/point_cells.hpp"

namespace scree::fractal {
namespace {

constexpr int kTasks = 32;                                     // fixed, so that sums do not depend on threads
constexpr std::uint64_t kThinningStream = 0x7468696e6e696e67;  // "thinning"

StructureFunction empty_result(const Annuli& annuli) {
  return {annuli, std::vector<PairSums>(static_cast<std::size_t>(annuli.count))};
}

/// Runs `body(task, accumulator)` for every task and adds their sums in order.
template <class Body>
void run_tasks(const Annuli& annuli, Executor& executor, const Body& body, StructureFunction& result) {
  std::vector<std::vector<PairSums>> parts(kTasks);
  std::vector<std::size_t> visited(kTasks);
  executor.for_ranges(kTasks, [&](int begin, int end) {
    for (int task = begin; task < end; ++task) {
      PairAccumulator accumulator(annuli);
      body(task, accumulator);
      parts[static_cast<std::size_t>(task)] = accumulator.sums();
      visited[static_cast<std::size_t>(task)] = accumulator.pairs();
    }
  });
  for (const auto& part : parts) add_sums(result.sums, part);
  result.pairs_visited = std::accumulate(visited.begin(), visited.end(), result.pairs_visited);
}

int share(int count, int task, int tasks) {
  return static_cast<int>(std::int64_t{count} * task / tasks);
}

void add_near(const PointCells& cells, double reach_m, const Annuli& annuli, Executor& executor,
              StructureFunction& result) {
  const auto body = [&](int task, PairAccumulator& accumulator) {
    std::vector<IndexRun> runs;
    for (int i = share(cells.count(), task, kTasks); i < share(cells.count(), task + 1, kTasks); ++i) {
      cells.runs_behind(i, reach_m, runs);
      accumulator.add(cells.columns(), i, runs);
    }
  };
  run_tasks(annuli, executor, body, result);
}

/// Cells a sixth of the reach, but not so small that most are empty.
double cell_for(double reach_m, double spacing_m) {
  return std::max(reach_m / 6.0, 2.0 * spacing_m);
}

double area_spacing_m(const PointColumns& points, std::size_t count) {
  const auto [x0, x1] = std::minmax_element(points.x_m.begin(), points.x_m.end());
  const auto [y0, y1] = std::minmax_element(points.y_m.begin(), points.y_m.end());
  return std::sqrt((double{*x1} - *x0) * (double{*y1} - *y0) / static_cast<double>(count));
}

/// Annuli [first, last) of one octave.
Annuli octave_of(const Annuli& annuli, int first, int last) {
  Annuli part = annuli;
  part.first_m = annuli.distance_m(first);
  part.count = last - first;
  return part;
}

}  // namespace

void add_sums(std::vector<PairSums>& total, const std::vector<PairSums>& part) {
  for (std::size_t k = 0; k < total.size(); ++k) {
    total[k].count += part[k].count;
    total[k].abs_m += part[k].abs_m;
    total[k].square_m2 += part[k].square_m2;
    total[k].log_m += part[k].log_m;
  }
}

StructureFunction all_pairs(const PointColumns& points, const Annuli& annuli, Executor& executor) {
  StructureFunction result = empty_result(annuli);
  PairColumns columns;
  columns.assign(points);
  const auto strip = [&](int begin, int end, PairAccumulator& accumulator) {
    for (int i = begin; i < end; ++i) {
      const IndexRun rest{i + 1, columns.count};
      accumulator.add(columns, i, {&rest, 1});
    }
  };
  // Early points have many partners, late ones few: a task takes one strip from either end.
  const auto body = [&](int task, PairAccumulator& accumulator) {
    const int mirrored = 2 * kTasks - 1 - task;
    strip(share(columns.count, task, 2 * kTasks), share(columns.count, task + 1, 2 * kTasks), accumulator);
    strip(share(columns.count, mirrored, 2 * kTasks), share(columns.count, mirrored + 1, 2 * kTasks), accumulator);
  };
  run_tasks(annuli, executor, body, result);
  return result;
}

StructureFunction near_pairs(const PointColumns& points, const Annuli& annuli, Executor& executor) {
  StructureFunction result = empty_result(annuli);
  std::vector<int> every(points.size());
  std::iota(every.begin(), every.end(), 0);
  const double reach_m = annuli.outer_m(annuli.count - 1);
  const PointCells cells(points, every, cell_for(reach_m, area_spacing_m(points, points.size())));
  add_near(cells, reach_m, annuli, executor, result);
  return result;
}

StructureFunction thinned_pairs(const PointColumns& points, const Annuli& annuli, const PairOptions& options,
                                double spacing_m, Executor& executor) {
  StructureFunction result = empty_result(annuli);
  std::vector<int> kept(points.size());
  std::iota(kept.begin(), kept.end(), 0);
  std::vector<double> lot(points.size());  // a point stays while its lot is below the share that is kept
  for (std::size_t i = 0; i < lot.size(); ++i)
    lot[i] = to_uniform(random_words(options.seed, kThinningStream, static_cast<std::int32_t>(i), 0)[0]);
  const auto octave_at = [&](int i) {
    return std::max(0, static_cast<int>(std::floor(std::log2(annuli.distance_m(i) / spacing_m) + 1e-9)));
  };
  for (int first = 0, last = 0; first < annuli.count; first = last) {
    const int octave = octave_at(first);
    while (last < annuli.count && octave_at(last) == octave) ++last;
    const double density = std::min(1.0, options.thinning_density * std::pow(4.0, -octave));
    std::erase_if(kept, [&](int i) { return lot[static_cast<std::size_t>(i)] >= density; });
    if (kept.size() < 2) break;
    const Annuli part = octave_of(annuli, first, last);
    const double reach_m = part.outer_m(part.count - 1);
    const PointCells cells(points, kept, cell_for(reach_m, area_spacing_m(points, kept.size())));
    StructureFunction sums = empty_result(part);
    add_near(cells, reach_m, part, executor, sums);
    std::copy(sums.sums.begin(), sums.sums.end(), result.sums.begin() + first);
    result.pairs_visited += sums.pairs_visited;
  }
  return result;
}

}  // namespace scree::fractal
