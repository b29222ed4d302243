#include "mapping/law_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/executor.hpp"
#include "core/simd.hpp"
#include "fractal/cell_mean_law.hpp"
#include "fractal/lanes.hpp"
#include "fractal/plane_scroll.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr int kRadius = 2;  // three boxes of five cells: a standard deviation of 2.4 cells
constexpr float kFollow = 0.2F;
constexpr float kSigmaMin = 0.02F;     // no window of cells tells D better
constexpr float kSigmaUnknown = 0.3F;  // exact planes
constexpr float kFlaggedShare = 0.1F;
constexpr float kWindowWeight = 100.0F;  // the window's law counts as one estimate with a sigma of 0.1
constexpr double kDimensionMin = 2.05, kDimensionMax = 2.95;
constexpr float kChangeMin_m = 1e-5F;

}  // namespace

fractal::FractalLaw LawField::of_cells(const fractal::FractalLaw& points) const {
  const auto cells = fractal::CellMeanLaw::instance().at(static_cast<float>(points.hurst()));
  const double hurst = std::clamp(static_cast<double>(cells.hurst), 3.0 - kDimensionMax, 3.0 - kDimensionMin);
  return {3.0 - hurst, static_cast<double>(cells.change) * points.rms_change_m(cell_m_) * std::pow(cell_m_, -hurst)};
}

void LawField::follow_window(const LatticeWindow& window) {
  const std::int64_t down = std::int64_t{window.min.y} - window_.min.y,
                     right = std::int64_t{window.min.x} - window_.min.x;
  const bool overlap = window.rows == window_.rows && window.columns == window_.columns &&
                       std::abs(down) < window.rows && std::abs(right) < window.columns;
  window_ = window;
  for (Grid<float>* grid : {&followed_dimension_, &followed_log_change_}) {
    if (!overlap)
      grid->assign(window.rows, window.columns, kUnknown);
    else
      fractal::scroll_plane([&](int r) { return grid->row(r).data(); }, window.rows, window.columns,
                            static_cast<int>(down), static_cast<int>(right), kUnknown);
  }
}

void LawField::load_row(const RoughnessMap& roughness, int row) {
  const auto log_cell = static_cast<float>(std::log(cell_m_));
  const auto weight = weight_.row(row), dimension = dimension_.row(row), log_change = log_change_.row(row);
  for (int column = 0; column < window_.columns; ++column) {
    const auto i = static_cast<std::size_t>(column);
    const float d = roughness.dimension(row, column), sigma = roughness.dimension_sigma(row, column);
    weight[i] = dimension[i] = log_change[i] = 0.0F;
    if (!std::isfinite(d)) continue;
    const float sure = std::isfinite(sigma) ? sigma : kSigmaUnknown;
    const bool flagged =
        (roughness.flags(row, column) & (fractal::kNoiseLimited | fractal::kNotFractal | fractal::kAtBound)) != 0;
    weight[i] = (flagged ? kFlaggedShare : 1.0F) / (sure * sure + kSigmaMin * kSigmaMin);
    dimension[i] = weight[i] * d;
    const float amplitude_m = std::max(roughness.amplitude_m(row, column), kChangeMin_m);
    log_change[i] = weight[i] * std::max(std::log(amplitude_m) + (3.0F - d) * log_cell, std::log(kChangeMin_m));
  }
}

void LawField::follow_row(const fractal::FractalLaw& window_law, int row) {
  const auto prior_dimension = static_cast<float>(window_law.dimension);
  const auto prior_log = static_cast<float>(std::log(std::max(window_law.rms_change_m(cell_m_), 1e-5)));
  const auto weight = weight_.smoothed(row), dimension = dimension_.smoothed(row), change = log_change_.smoothed(row);
  const float unit = kWindowWeight * weight_.own_weight();
  for (int column = 0; column < window_.columns; ++column) {
    const auto i = static_cast<std::size_t>(column);
    const float total = weight[i] + unit;
    const float seen_dimension = (dimension[i] + unit * prior_dimension) / total;
    const float seen_log = (change[i] + unit * prior_log) / total;
    float &d = followed_dimension_(row, column), &s = followed_log_change_(row, column);
    d = std::isfinite(d) ? d + kFollow * (seen_dimension - d) : seen_dimension;
    s = std::isfinite(s) ? s + kFollow * (seen_log - s) : seen_log;
  }
}

void LawField::write_row(int row) {
  const auto log_cell = static_cast<float>(std::log(cell_m_));
  const fractal::CellMeanLaw& cell_law = fractal::CellMeanLaw::instance();
  for (int column = 0; column < window_.columns; ++column) {
    const auto of_cells = cell_law.at(3.0F - followed_dimension_(row, column));
    const float change_m =
        std::min(std::exp(followed_log_change_(row, column)), limit_.change_m(row, column, of_cells));
    const float hurst =
        std::clamp(of_cells.hurst, 3.0F - static_cast<float>(kDimensionMax), 3.0F - static_cast<float>(kDimensionMin));
    law_.dimension(row, column) = 3.0F - hurst;
    law_.amplitude_m(row, column) = of_cells.change * change_m * std::exp(-hurst * log_cell);
    const float hidden = kHidden * (followed_dimension_(row, column) - 2.0F);
    relief_m2_(row, column) = of_cells.within * change_m * change_m;
    hidden_m2_(row, column) = hidden * hidden * relief_m2_(row, column);
  }
}

void LawField::update(const LatticeWindow& window, const RoughnessMap& roughness, const fractal::FractalLaw& window_law,
                      const GroundLayers& ground, Executor& executor) {
  if (window != window_) follow_window(window);
  if (relief_m2_.rows() != window.rows || relief_m2_.columns() != window.columns) {
    for (Grid<float>* grid : {&law_.dimension, &law_.amplitude_m, &relief_m2_, &hidden_m2_})
      grid->reshape(window.rows, window.columns);
    for (fractal::BoxCascade* box : {&weight_, &dimension_, &log_change_})
      box->resize(window.rows, window.columns, kRadius);
  }
  law_.law = of_cells(window_law);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) load_row(roughness, row);
  });
  limit_.update(ground, executor);
  for (fractal::BoxCascade* box : {&weight_, &dimension_, &log_change_}) box->smooth();
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      follow_row(window_law, row);
      write_row(row);
    }
  });
}

}  // namespace scree::mapping
