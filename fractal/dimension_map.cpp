#include "fractal/dimension_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simd.hpp"
#include "fractal/box_sum.hpp"
#include "fractal/dimension_fit.hpp"
#include "fractal/increments.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// A noise variance above C is more than half of the shortest increments' energy for every H: the header's "most".
constexpr float kNoiseLimitTau = 1.0F;
/// 99.9 % point of chi-square with 8 classes − 2 parameters = 6 degrees of freedom.
constexpr float kChiSquareLimit = 22.458F;

SCREE_INLINE void log_of_eight_means(float* energy, const float* count) {
  Lanes e, n;
  std::memcpy(&e, energy, sizeof e);
  std::memcpy(&n, count, sizeof n);
  constexpr Lanes kOne = {1, 1, 1, 1, 1, 1, 1, 1};
  const Lanes mean = e / (n > kOne ? n : kOne), floor = 1e-36F * kOne;
  fast_log<Lanes, IntLanes>(mean > floor ? mean : floor, e);
  std::memcpy(energy, &e, sizeof e);
}

/// Mean energies to their logarithms, in place; an energy of zero becomes log 1e-36.
SCREE_CLONES void log_of_mean(float* energy, const float* count, std::size_t n) {
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) log_of_eight_means(energy + i, count + i);
  if (i == n) return;
  std::array<float, 8> e{}, k{};
  std::copy(energy + i, energy + n, e.begin());
  std::copy(count + i, count + n, k.begin());
  log_of_eight_means(e.data(), k.data());
  std::copy(e.begin(), e.begin() + static_cast<std::ptrdiff_t>(n - i), energy + i);
}

}  // namespace

struct DimensionMapper::Tables {
  DimensionMapConfig config;
  float log_cell = 0.0F;
  MaskedHeights heights;
  std::array<BoxSum, kClassCount> energies, counts;
  BoxSum known, variance, inverse_hits;
  float rounding_variance = 0.0F;
  Support support = Support::centre_point;

  void resize(int rows, int columns);
  void load(const Grid<float>& height_m, const Grid<std::uint16_t>& hits);
  void sum_class(int c);
  void sum_cell_quantities(const Grid<float>& height_m, const Grid<float>& variance_m2,
                           const Grid<std::uint16_t>& hits);
  void estimate(const DimensionTables& tables, std::size_t cell, DimensionMap& out) const;
  bool gather(std::size_t cell, EnergyWindow& window, float& log_unit, bool& smooth) const;
};

void DimensionMapper::Tables::resize(int rows, int columns) {
  if (rows == heights.rows && columns == heights.columns) return;
  heights.rows = rows;
  heights.columns = columns;
  const auto padded = static_cast<std::size_t>(rows + 2 * kIncrementReach) * static_cast<std::size_t>(heights.stride());
  heights.height.assign(padded, 0.0F);
  heights.mask.assign(padded, 0.0F);
  for (auto* planes : {&energies, &counts})
    for (BoxSum& plane : *planes) plane.resize(rows, columns, config.radius_cells);
  for (BoxSum* plane : {&known, &variance, &inverse_hits}) plane->resize(rows, columns, config.radius_cells);
}

void DimensionMapper::Tables::load(const Grid<float>& height_m, const Grid<std::uint16_t>& hits) {
  float largest = 0.0F;
  support = Support::centre_point;
  for (int r = 0; r < height_m.rows(); ++r) {
    const auto row = height_m.row(r);
    float* height = heights.height.data() + heights.offset(r, 0);
    float* mask = heights.mask.data() + heights.offset(r, 0);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool is_known = std::isfinite(row[i]);
      height[i] = is_known ? row[i] : 0.0F;
      mask[i] = is_known ? 1.0F : 0.0F;
      largest = std::max(largest, std::abs(height[i]));
      if (is_known && hits.row(r)[i] > 0) support = Support::block;
    }
  }
  // A float height is rounded to half a unit in its last place: noise of a twelfth of the square of that unit.
  const float unit = largest * std::numeric_limits<float>::epsilon();
  rounding_variance = unit * unit / 12.0F;
}

void DimensionMapper::Tables::sum_class(int c) {
  const auto k = static_cast<std::size_t>(c);
  for (int r = 0; r < heights.rows; ++r)
    increment_energies(heights, kClasses[k], r, energies[k].row(r), counts[k].row(r));
  energies[k].sum();
  counts[k].sum();
  log_of_mean(energies[k].sums().data(), counts[k].sums().data(), energies[k].sums().size());
}

void DimensionMapper::Tables::sum_cell_quantities(const Grid<float>& height_m, const Grid<float>& variance_m2,
                                                  const Grid<std::uint16_t>& hits) {
  for (int r = 0; r < height_m.rows(); ++r) {
    const auto noise = variance_m2.row(r);
    const auto count = hits.row(r);
    const float* mask = heights.mask.data() + heights.offset(r, 0);
    const auto known_row = known.row(r), variance_row = variance.row(r), inverse_row = inverse_hits.row(r);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      known_row[i] = mask[i];
      variance_row[i] = mask[i] > 0.0F && noise[i] > 0.0F ? noise[i] : 0.0F;
      inverse_row[i] = mask[i] / static_cast<float>(std::max<std::uint16_t>(count[i], 1));
    }
  }
  known.sum();
  variance.sum();
  inverse_hits.sum();
}

/// False when the window holds too little. `smooth`: complete increments, but no energy at all.
bool DimensionMapper::Tables::gather(std::size_t cell, EnergyWindow& window, float& log_unit, bool& smooth) const {
  float fewest = std::numeric_limits<float>::max();
  for (const BoxSum& plane : counts) fewest = std::min(fewest, plane.sums()[cell]);
  const float complete = 0.5F * counts[0].sums()[cell];  // axis increments of step 1, both directions
  if (fewest < 1.0F || complete < static_cast<float>(config.min_effective_cells)) return false;
  log_unit = energies[0].sums()[cell];
  float lowest = log_unit;
  for (std::size_t c = 0; c < energies.size(); ++c) {
    const float log_energy = energies[c].sums()[cell];
    lowest = std::min(lowest, log_energy);
    window.log_energy[c] = log_energy - log_unit;
  }
  smooth = lowest < -80.0F;
  const float cells = known.sums()[cell];
  const float noise = variance.sums()[cell] / cells + rounding_variance;
  window.noise = smooth ? 0.0F : noise * std::exp(-log_unit);
  window.nugget = inverse_hits.sums()[cell] / cells;
  // A known centre has both axis neighbours with probability fill²: 1 inside a solid patch, p for cells missing at
  // random.
  window.fill = std::min(1.0F, std::sqrt(complete / cells));
  window.cells = cells / window.fill;
  return true;
}

void DimensionMapper::Tables::estimate(const DimensionTables& tables, std::size_t cell, DimensionMap& out) const {
  EnergyWindow window;
  float log_unit = 0.0F;
  bool smooth = false;
  if (!gather(cell, window, log_unit, smooth)) {
    out.dimension[cell] = out.dimension_sigma[cell] = out.amplitude_m[cell] = kNaN;
    out.flags[cell] = kTooLittleData;
    return;
  }
  if (smooth) {  // an exact plane: as smooth as the scale of D goes, nothing to measure
    out.dimension[cell] = static_cast<float>(3.0 - kMaxHurst);
    out.dimension_sigma[cell] = kNaN;
    out.amplitude_m[cell] = 0.0F;
    out.flags[cell] = kNoiseLimited;
    return;
  }
  const EnergyFit fit = fit_energies(tables, window);
  out.dimension[cell] = 3.0F - fit.hurst;
  out.dimension_sigma[cell] = fit.sigma_hurst;
  out.amplitude_m[cell] = std::sqrt(fit.c_value) * std::exp(0.5F * log_unit - fit.hurst * log_cell);
  out.flags[cell] = static_cast<std::uint8_t>((fit.tau > kNoiseLimitTau || fit.at_bound ? kNoiseLimited : 0) |
                                              (fit.chi_square > kChiSquareLimit ? kNotFractal : 0));
}

DimensionMapper::DimensionMapper(const DimensionMapConfig& config) : tables_(std::make_unique<Tables>()) {
  tables_->config = config;
  tables_->log_cell = static_cast<float>(std::log(config.cell_m));
  dimension_tables(Support::block);  // 0.2 s that the first frame of a live map need not wait for
}
DimensionMapper::~DimensionMapper() = default;
DimensionMapper::DimensionMapper(DimensionMapper&&) noexcept = default;
DimensionMapper& DimensionMapper::operator=(DimensionMapper&&) noexcept = default;

void DimensionMapper::update(const Grid<float>& height_m, const Grid<float>& variance_m2,
                             const Grid<std::uint16_t>& hits, Executor& executor, DimensionMap& out) {
  const int rows = height_m.rows(), columns = height_m.columns();
  assert(variance_m2.rows() == rows && variance_m2.columns() == columns);
  assert(hits.rows() == rows && hits.columns() == columns);
  Tables& work = *tables_;
  work.resize(rows, columns);
  out.dimension.assign(rows, columns, kNaN);
  out.dimension_sigma.assign(rows, columns, kNaN);
  out.amplitude_m.assign(rows, columns, kNaN);
  out.flags.assign(rows, columns, kTooLittleData);
  work.load(height_m, hits);
  const DimensionTables& tables = dimension_tables(work.support);
  executor.for_ranges(kClassCount + 1, [&](int begin, int end) {
    for (int task = begin; task < end; ++task)
      if (task < kClassCount)
        work.sum_class(task);
      else
        work.sum_cell_quantities(height_m, variance_m2, hits);
  });
  executor.for_ranges(rows, [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(columns);
    for (std::size_t cell = static_cast<std::size_t>(begin) * width; cell < static_cast<std::size_t>(end) * width;
         ++cell)
      work.estimate(tables, cell, out);
  });
}

}  // namespace scree::fractal
