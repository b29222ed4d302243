#include "mapping/bend_limit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "fractal/lanes.hpp"
#include "mapping/map_cell.hpp"

namespace scree::mapping {

namespace {

constexpr std::array<int, 2> kLags{1, 4};  // cells
constexpr float kLeastBend_m = 1e-3F;
constexpr float kLogOfNormal = 0.63518F;  // −E log |n|, n standard normal
constexpr float kSpreadOfLog = 1.1107F;   // standard deviation of log |n|
constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr float kLeastChange_m = 1e-5F;

float places(const GroundLayers& ground, int row, int column) {
  return 1.0F / static_cast<float>(std::clamp<int>(ground.hits(row, column), 1, kIndependentPlaces));
}

}  // namespace

void BendLimit::load_row(const GroundLayers& ground, int row, Lag& lag) {
  const auto logs = lag.logs.row(row), count = lag.count.row(row), noise_m2 = lag.noise_m2.row(row),
             share = lag.places.row(row);
  const Grid<float>& height_m = ground.height_m;
  for (int column = 0; column < height_m.columns(); ++column) {
    const auto i = static_cast<std::size_t>(column);
    logs[i] = count[i] = noise_m2[i] = share[i] = 0.0F;
    if (ground.measured(row, column) == 0) continue;
    for (const auto& [dr, dc] : {std::pair{0, lag.cells}, std::pair{lag.cells, 0}}) {
      if (!height_m.contains(row - dr, column - dc) || !height_m.contains(row + dr, column + dc)) continue;
      const float bend_m =
          height_m(row - dr, column - dc) - 2.0F * height_m(row, column) + height_m(row + dr, column + dc);
      if (!std::isfinite(bend_m)) continue;
      float log;
      fractal::fast_log<float, std::int32_t>(std::max(std::abs(bend_m), kLeastBend_m), log);
      logs[i] += log;
      count[i] += 1.0F;
      const Grid<float>& noise = ground.noise_variance_m2;
      noise_m2[i] += noise(row - dr, column - dc) + 4.0F * noise(row, column) + noise(row + dr, column + dc);
      share[i] += places(ground, row - dr, column - dc) + 4.0F * places(ground, row, column) +
                  places(ground, row + dr, column + dc);
    }
  }
}

void BendLimit::add_up(Lag& lag, int rows) {
  lag.total = {};
  for (int row = 0; row < rows; ++row) {
    const auto sum = [row](fractal::BoxSum& of) {
      double out = 0.0;
      for (const float value : of.row(row)) out += static_cast<double>(value);
      return out;
    };
    lag.total.logs += sum(lag.logs);
    lag.total.count += sum(lag.count);
    lag.total.noise_m2 += sum(lag.noise_m2);
    lag.total.places += sum(lag.places);
  }
}

void BendLimit::update(const GroundLayers& ground, Executor& executor) {
  const int rows = ground.height_m.rows(), columns = ground.height_m.columns();
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    Lag& lag = lags_[i];
    const Grid<float>& sums = lag.logs.sums();
    if (lag.cells == 0 || sums.rows() != rows || sums.columns() != columns) {
      lag.cells = kLags[i];
      for (fractal::BoxSum* box : {&lag.logs, &lag.count, &lag.noise_m2, &lag.places})
        box->resize(rows, columns, 2 * lag.cells);
    }
  }
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (Lag& lag : lags_) load_row(ground, row, lag);
  });
  for (Lag& lag : lags_) {
    add_up(lag, rows);
    for (fractal::BoxSum* box : {&lag.logs, &lag.count, &lag.noise_m2, &lag.places}) box->sum(scratch_);
  }
}

/// What chance may hide of the bends stays: the noise is taken off the mean square down to that share of it.
float BendLimit::change_m(const Lag& lag, float logs, float count, float noise_m2, float places,
                          const fractal::CellMeanLaw::Values& of_cells) {
  if (count < kBends) return kNoLimit;
  const float bend_m2 = std::exp(2.0F * (logs / count + kLogOfNormal));
  const float chance = std::min(1.0F, 2.0F * kSpreadOfLog / std::sqrt(count));
  const float excess_m2 = std::max(bend_m2 - noise_m2 / count, chance * bend_m2);
  const float change = of_cells.change * std::pow(static_cast<float>(lag.cells), of_cells.hurst);
  const float of_change = (4.0F - std::pow(4.0F, of_cells.hurst)) * change * change + of_cells.within * places / count;
  return std::max(kTrust * std::sqrt(excess_m2 / of_change), kLeastChange_m);
}

float BendLimit::change_m(int row, int column, const fractal::CellMeanLaw::Values& of_cells) const {
  float least = kNoLimit;
  for (const Lag& lag : lags_)
    least = std::min(least, change_m(lag, lag.logs.sums()(row, column), lag.count.sums()(row, column),
                                     lag.noise_m2.sums()(row, column), lag.places.sums()(row, column), of_cells));
  if (least < kNoLimit) return least;
  for (const Lag& lag : lags_)
    least = std::min(least,
                     change_m(lag, static_cast<float>(lag.total.logs), static_cast<float>(lag.total.count),
                              static_cast<float>(lag.total.noise_m2), static_cast<float>(lag.total.places), of_cells));
  return least;
}

}  // namespace scree::mapping
