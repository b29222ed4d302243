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
constexpr float kLog4 = 1.3862944F;
constexpr float kRootOfNormal = 2.188F;  // 1/(E √|n|)⁴, n standard normal
constexpr float kSpreadOfRoot = 1.70F;   // standard deviation of √|n|, to its mean, in the fourth power
constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr float kLeastChange_m = 1e-5F;

float places(const GroundLayers& ground, int row, int column) {
  return 1.0F / static_cast<float>(std::clamp<int>(ground.hits(row, column), 1, kIndependentPlaces));
}

}  // namespace

void BendLimit::load_row(const GroundLayers& ground, int row, Lag& lag) {
  const auto roots = lag.roots.row(row), count = lag.count.row(row), noise_m2 = lag.noise_m2.row(row),
             share = lag.places.row(row);
  const Grid<float>& height_m = ground.height_m;
  for (int column = 0; column < height_m.columns(); ++column) {
    const auto i = static_cast<std::size_t>(column);
    roots[i] = count[i] = noise_m2[i] = share[i] = 0.0F;
    if (ground.measured(row, column) == 0) continue;
    for (const auto& [dr, dc] : {std::pair{0, lag.cells}, std::pair{lag.cells, 0}}) {
      if (!height_m.contains(row - dr, column - dc) || !height_m.contains(row + dr, column + dc)) continue;
      const float bend_m =
          height_m(row - dr, column - dc) - 2.0F * height_m(row, column) + height_m(row + dr, column + dc);
      if (!std::isfinite(bend_m)) continue;
      roots[i] += std::sqrt(std::abs(bend_m));
      count[i] += 1.0F;
      const Grid<float>& noise = ground.noise_variance_m2;
      noise_m2[i] += noise(row - dr, column - dc) + 4.0F * noise(row, column) + noise(row + dr, column + dc);
      share[i] += places(ground, row - dr, column - dc) + 4.0F * places(ground, row, column) +
                  places(ground, row + dr, column + dc);
    }
  }
}

void BendLimit::add_up(Lag& lag, int rows) {
  const auto total = [rows](fractal::BoxSum& of) {
    double out = 0.0;
    for (int row = 0; row < rows; ++row)
      for (const float value : of.row(row)) out += static_cast<double>(value);
    return static_cast<float>(out);
  };
  lag.total = {total(lag.roots), total(lag.count), total(lag.noise_m2), total(lag.places)};
}

void BendLimit::update(const GroundLayers& ground, Executor& executor) {
  const int rows = ground.height_m.rows(), columns = ground.height_m.columns();
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    Lag& lag = lags_[i];
    const Grid<float>& sums = lag.roots.sums();
    if (lag.cells == 0 || sums.rows() != rows || sums.columns() != columns) {
      lag.cells = kLags[i];
      for (fractal::BoxSum* box : lag.boxes()) box->resize(rows, columns, 2 * lag.cells);
    }
  }
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (Lag& lag : lags_) load_row(ground, row, lag);
  });
  for (Lag& lag : lags_) {
    add_up(lag, rows);
    for (fractal::BoxSum* box : lag.boxes()) box->sum(scratch_);
  }
}

/// What chance may hide of the bends stays: the noise is taken off the mean square down to that share of it.
float BendLimit::change_m(const Lag& lag, const Sums& sums, const fractal::CellMeanLaw::Values& of_cells) {
  if (sums.count < kBends) return kNoLimit;
  const float root = sums.roots / sums.count, bend_m2 = kRootOfNormal * root * root * root * root;
  const float chance = std::min(1.0F, kSpreadOfRoot / std::sqrt(sums.count));
  const float excess_m2 = std::max(bend_m2 - sums.noise_m2 / sums.count, chance * bend_m2);
  const float octaves2 = fractal::fast_exp(kLog4 * of_cells.hurst);  // 4^h, the square of one octave's growth
  const float growth = lag.cells == 1 ? 1.0F : octaves2;
  const float of_change = (4.0F - octaves2) * growth * growth * of_cells.change * of_cells.change +
                          of_cells.within * sums.places / sums.count;
  return std::max(kTrust * std::sqrt(excess_m2 / of_change), kLeastChange_m);
}

float BendLimit::change_m(int row, int column, const fractal::CellMeanLaw::Values& of_cells) const {
  float least = kNoLimit;
  for (const Lag& lag : lags_) {
    const auto at = [&](const fractal::BoxSum& of) { return of.sums()(row, column); };
    least = std::min(least, change_m(lag, {at(lag.roots), at(lag.count), at(lag.noise_m2), at(lag.places)}, of_cells));
  }
  if (least < kNoLimit) return least;
  for (const Lag& lag : lags_) least = std::min(least, change_m(lag, lag.total, of_cells));
  return least;
}

}  // namespace scree::mapping
