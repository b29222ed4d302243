#include "mapping/local_elevation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

fractal::ReconstructionConfig reconstruction_config(const LocalElevationConfig& config) {
  fractal::ReconstructionConfig out;
  out.cell_m = config.cell_m;
  out.max_cells = config.size_cells;
  out.seed = config.seed;
  out.residual_fields = config.draws;
  out.standard_deviation = true;
  return out;
}

}  // namespace

LocalElevation::LocalElevation(const LocalElevationConfig& config)
    : config_(config), reconstructor_(reconstruction_config(config)) {}

void LocalElevation::learn(const GroundLayers& ground, const LatticeWindow& window, Executor& executor) {
  squared_ratio_.assign(window.rows, window.columns, kUnknown);
  const int down = window.min.y - last_window_.min.y, right = window.min.x - last_window_.min.x;
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < window.columns; ++column) {
        if (ground.measured(row, column) == 0 || !predicted_mean_m_.contains(row + down, column + right)) continue;
        const float error_m = ground.height_m(row, column) - predicted_mean_m_(row + down, column + right);
        const float variance_m2 = predicted_variance_m2_(row + down, column + right) + ground.variance_m2(row, column);
        squared_ratio_(row, column) = error_m * error_m / variance_m2;  // NaN where nothing was predicted
      }
  });
  calibration_.update(window, squared_ratio_, executor);
}

void LocalElevation::remember(const GroundLayers& ground, const LatticeWindow& window,
                              const Grid<std::uint8_t>& predicted, Executor& executor) {
  last_window_ = window;
  for (Grid<float>* grid : {&predicted_mean_m_, &predicted_variance_m2_})
    grid->assign(window.rows, window.columns, kUnknown);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < window.columns; ++column) {
        if (predicted(row, column) == 0 || ground.measured(row, column) != 0) continue;
        const float sd_m = filled_.sd_m(row, column);
        predicted_mean_m_(row, column) = filled_.mean_m(row, column);
        predicted_variance_m2_(row, column) = sd_m * sd_m / calibration_.factor()(row, column);
      }
  });
}

void LocalElevation::set_ceilings(const GroundLayers& ground, const Grid<std::uint8_t>& predicted, Executor& executor) {
  ceiling_m_.assign(predicted.rows(), predicted.columns(), kUnknown);
  for_rows(executor, predicted.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < predicted.columns(); ++column)
        if (predicted(row, column) != 0 && ground.measured(row, column) == 0)
          ceiling_m_(row, column) = ground.ceiling_m(row, column);
  });
}

void LocalElevation::calibrate(const fractal::LawMap& law) {
  law_ = law;
  const Grid<float>& factor = calibration_.factor();
  for (std::size_t i = 0; i < factor.size(); ++i) law_.amplitude_m[i] *= std::sqrt(factor[i]);
}

fractal::Reconstruction* LocalElevation::update(const GroundLayers& ground, const LatticeWindow& window,
                                                const fractal::LawMap& law, const Grid<std::uint8_t>& predicted,
                                                Executor& executor) {
  if (std::find(ground.measured.begin(), ground.measured.end(), 1) == ground.measured.end()) return nullptr;
  learn(ground, window, executor);
  calibrate(law);
  set_ceilings(ground, predicted, executor);
  reconstructor_.reconstruct(ground.height_m, ground.variance_m2, ceiling_m_, window, law_, executor, filled_);
  remember(ground, window, predicted, executor);
  return &filled_;
}

}  // namespace scree::mapping
