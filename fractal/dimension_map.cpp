#include "fractal/dimension_map.hpp"

#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "fractal/dimension_fit.hpp"
#include "fractal/lanes.hpp"
#include "fractal/plane_scroll.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// A noise variance above C is more than half of the shortest increments' energy for every H: the header's "most".
constexpr float kNoiseLimitTau = 1.0F;
/// 99.9 % points of chi-square with 1 … 6 degrees of freedom.
constexpr std::array<float, 6> kChiSquareLimits = {10.828F, 13.816F, 16.266F, 18.467F, 20.515F, 22.458F};

float chi_square_limit(int degrees) {
  return kChiSquareLimits[static_cast<std::size_t>(degrees - 1)];
}

void set_too_little(std::size_t cell, DimensionMap& out) {
  out.dimension[cell] = out.dimension_sigma[cell] = out.amplitude_m[cell] = kNaN;
  out.flags[cell] = kTooLittleData;
}

/// An exact plane: as smooth as the scale of D goes, nothing to measure.
void set_flat(std::size_t cell, DimensionMap& out) {
  out.dimension[cell] = static_cast<float>(3.0 - kMaxHurst);
  out.dimension_sigma[cell] = kNaN;
  out.amplitude_m[cell] = 0.0F;
  out.flags[cell] = kAtBound;
}

std::uint8_t flags_of(const EnergyFit& fit, std::uint8_t missing) {
  const int degrees = kClassCount - std::popcount(missing) - 2;
  const bool noise_limited = fit.tau > kNoiseLimitTau;
  const bool not_fractal = fit.chi_square > chi_square_limit(degrees);
  const bool anisotropic = fit.contrast_chi_square > chi_square_limit(kContrastClassCount);
  return static_cast<std::uint8_t>((noise_limited ? kNoiseLimited : 0) | (not_fractal ? kNotFractal : 0) |
                                   (anisotropic ? kAnisotropic : 0) | (fit.at_bound ? kAtBound : 0));
}

/// Windows of one row on their way to the fit.
struct Batch {
  static constexpr std::size_t kSize = 64;
  std::array<EnergyWindow, kSize> windows;
  std::array<EnergyFit, kSize> fits;
  std::array<float, kSize> log_units;
  std::array<std::size_t, kSize> cells;
  std::size_t size = 0;

  void fit_into(const DimensionTables& tables, float log_cell, DimensionMap& out) {
    fit_energies(tables, {windows.data(), size}, {fits.data(), size});
    for (std::size_t i = 0; i < size; ++i) {
      const EnergyFit& fit = fits[i];
      out.dimension[cells[i]] = 3.0F - fit.hurst;
      out.dimension_sigma[cells[i]] = fit.sigma_hurst;
      out.amplitude_m[cells[i]] = std::sqrt(fit.c_value) * fast_exp(0.5F * log_units[i] - fit.hurst * log_cell);
      out.flags[cells[i]] = flags_of(fit, windows[i].missing);
    }
    size = 0;
  }
};

}  // namespace

DimensionMapper::DimensionMapper(const DimensionMapConfig& config)
    : config_(config), log_cell_(static_cast<float>(std::log(config.cell_m))), planes_(config.radius_cells) {
  dimension_tables(Support::block);  // 0.2 s that the first frame of a live map need not wait for
}

void DimensionMapper::clear(int rows, int columns) {
  planes_.clear(rows, columns);
  for (Grid<float>* grid : {&map_.dimension, &map_.dimension_sigma, &map_.amplitude_m})
    grid->assign(rows, columns, kNaN);
  map_.flags.assign(rows, columns, kTooLittleData);
  stale_.assign(rows, columns, 1);
}

void DimensionMapper::scroll_to(const LatticeWindow& window) {
  const std::int64_t down = std::int64_t{window.min.y} - window_.min.y,
                     right = std::int64_t{window.min.x} - window_.min.x;
  const bool overlap = window.rows == window_.rows && window.columns == window_.columns &&
                       std::abs(down) < window.rows && std::abs(right) < window.columns;
  window_ = window;
  if (!overlap) return clear(window.rows, window.columns);
  if (down == 0 && right == 0) return;
  const int rows = static_cast<int>(down), columns = static_cast<int>(right);
  planes_.scroll(rows, columns);
  for (Grid<float>* grid : {&map_.dimension, &map_.dimension_sigma, &map_.amplitude_m})
    scroll_plane([&](int r) { return grid->row(r).data(); }, window.rows, window.columns, rows, columns, kNaN);
  scroll_plane([&](int r) { return map_.flags.row(r).data(); }, window.rows, window.columns, rows, columns,
               std::uint8_t{kTooLittleData});
  scroll_plane([&](int r) { return stale_.row(r).data(); }, window.rows, window.columns, rows, columns,
               std::uint8_t{1});
}

void DimensionMapper::fit_row(const DimensionTables& tables, const Grid<std::uint8_t>* wanted, int row) {
  const BitPlane::Span span = planes_.changed().span(row);
  for (int column = span.begin; column < span.end; ++column)
    if (planes_.changed().test(row, column)) stale_(row, column) = 1;
  Batch batch;
  for (int column = 0; column < planes_.columns(); ++column) {
    if (stale_(row, column) == 0 || (wanted != nullptr && (*wanted)(row, column) == 0)) continue;
    stale_(row, column) = 0;
    const std::size_t cell =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(planes_.columns()) + static_cast<std::size_t>(column);
    switch (planes_.window(cell, config_.min_effective_cells, batch.windows[batch.size], batch.log_units[batch.size])) {
      case EnergyPlanes::Content::too_little:
        set_too_little(cell, map_);
        break;
      case EnergyPlanes::Content::flat:
        set_flat(cell, map_);
        break;
      case EnergyPlanes::Content::rough:
        batch.cells[batch.size++] = cell;
        if (batch.size == Batch::kSize) batch.fit_into(tables, log_cell_, map_);
    }
  }
  batch.fit_into(tables, log_cell_, map_);
}

const DimensionMap& DimensionMapper::update(const LatticeWindow& window, const Grid<float>& height_m,
                                            const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits,
                                            Executor& executor) {
  assert(height_m.rows() == window.rows && height_m.columns() == window.columns);
  assert(variance_m2.rows() == window.rows && variance_m2.columns() == window.columns);
  assert(hits.rows() == window.rows && hits.columns() == window.columns);
  scroll_to(window);
  planes_.update({height_m, variance_m2, hits}, executor);
  fit(nullptr, executor);
  return map_;
}

const DimensionMap& DimensionMapper::update(const LatticeWindow& window, const Grid<float>& height_m,
                                            const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits,
                                            const Grid<std::uint8_t>& wanted, Executor& executor) {
  assert(wanted.rows() == window.rows && wanted.columns() == window.columns);
  scroll_to(window);
  planes_.update({height_m, variance_m2, hits}, executor);
  fit(&wanted, executor);
  return map_;
}

void DimensionMapper::fit(const Grid<std::uint8_t>* wanted, Executor& executor) {
  const DimensionTables& tables = dimension_tables(planes_.support());
  const auto rows = [&](int begin, int end) {
    for (int row = begin; row < end; ++row) fit_row(tables, wanted, row);
  };
  for_rows(executor, planes_.rows(), rows);
}

void DimensionMapper::update(const Grid<float>& height_m, const Grid<float>& variance_m2,
                             const Grid<std::uint16_t>& hits, Executor& executor, DimensionMap& out) {
  window_ = {};
  out = update(LatticeWindow{{0, 0}, height_m.rows(), height_m.columns()}, height_m, variance_m2, hits, executor);
  window_ = {};
}

}  // namespace scree::fractal
