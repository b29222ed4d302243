#include "mapping/layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/parallel.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

fractal::DimensionMapConfig dimension_config(const MapConfig& config) {
  fractal::DimensionMapConfig out;
  out.cell_m = config.cell_m;
  out.radius_cells = config.dimension_radius_cells;
  return out;
}

fractal::ReconstructionConfig reconstruction_config(const MapConfig& config) {
  fractal::ReconstructionConfig out;
  out.cell_m = config.cell_m;
  out.max_cells = config.size_cells;
  out.seed = config.seed;
  return out;
}

ShapeConfig shape_config(const MapConfig& config) {
  const double footprint_m = std::max(config.vehicle.track_m, config.vehicle.wheelbase_m);
  ShapeConfig out;
  out.cell_m = config.cell_m;
  out.slope_radius_cells = std::max(1, static_cast<int>(std::lround(0.5 * footprint_m / config.cell_m)));
  out.step_radius_m = config.vehicle.wheel_radius_m;
  return out;
}

StateConfig state_config(const MapConfig& config) {
  return {config.reconstruct_reach_m / config.cell_m, static_cast<float>(config.drop_margin_m)};
}

}  // namespace

Layers::Layers(const MapConfig& config)
    : config_(config),
      dimension_mapper_(dimension_config(config)),
      reconstructor_(reconstruction_config(config)),
      states_(state_config(config)),
      shape_(shape_config(config)) {}

// On a slope the places of a cell's few returns are noise of its height: slope² · cell² / 12 for one return.
void Layers::estimate_roughness(const LatticeWindow& window, Executor& executor) {
  shape_.slopes(ground_.height_m, executor, measured_slope_rad_);
  place_variance_m2_.assign(ground_.height_m.rows(), ground_.height_m.columns(), 0.0F);
  const auto place_m2 = static_cast<float>(config_.cell_m * config_.cell_m / 12.0);
  for_rows(executor, place_variance_m2_.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < place_variance_m2_.columns(); ++column) {
        if (ground_.measured(row, column) == 0) continue;
        const float slope = measured_slope_rad_(row, column);
        const float rise = std::isfinite(slope) ? std::tan(slope) : 0.0F;
        place_variance_m2_(row, column) = ground_.noise_variance_m2(row, column) +
                                          rise * rise * place_m2 / static_cast<float>(ground_.support(row, column));
      }
  });
  roughness_ = &dimension_mapper_.update(window, ground_.height_m, place_variance_m2_, ground_.support, executor);
}

const fractal::Reconstruction* Layers::reconstruct(const LatticeWindow& window, Executor& executor) {
  const auto seen = window_law_.estimate(*roughness_, ground_.measured);
  if (seen) law_ = law_ ? follow(*law_, *seen) : *seen;
  const bool any = std::find(ground_.measured.begin(), ground_.measured.end(), 1) != ground_.measured.end();
  if (!law_ || !any) return nullptr;
  reconstructor_.reconstruct(ground_.height_m, ground_.variance_m2, window, *law_, executor, filled_);
  return &filled_;
}

void Layers::compute(const RollingGrid<MapCell>& map, std::uint32_t now_ms, Executor& executor, MapSnapshot& out) {
  const LatticeWindow& window = map.window();
  ground_.unroll(map, config_.cell_m, executor, now_ms);
  out.cell_age_s = ground_.cell_age_s;
  estimate_roughness(window, executor);
  const fractal::Reconstruction* filled = reconstruct(window, executor);
  states_.classify(ground_, filled, executor, out.state, out.elevation_m);
  shape_.update(out.elevation_m, ground_.noise_variance_m2, ground_.relief_m2, executor, out.slope_rad, out.step_m,
                deviation_m_);
  for (Grid<float>* grid : {&out.elevation_sigma_m, &out.dimension, &out.dimension_sigma, &out.amplitude_m})
    grid->assign(window.rows, window.columns, kUnknown);
  out.cost.assign(window.rows, window.columns, kCostUnknown);
  out.hits.assign(window.rows, window.columns, 0);
  out.dimension_flags.assign(window.rows, window.columns, fractal::kTooLittleData);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) publish_row(row, out);
  });
}

void Layers::publish_row(int row, MapSnapshot& out) const {
  for (int column = 0; column < out.window.columns; ++column) {
    GroundShape ground;
    ground.state = out.state(row, column);
    out.hits(row, column) = ground_.hits(row, column);
    if (ground.state == CellState::measured)
      out.elevation_sigma_m(row, column) = std::sqrt(ground_.variance_m2(row, column));
    if (ground.state == CellState::measured || ground.state == CellState::reconstructed) {
      const float amplitude_m = roughness_->amplitude_m(row, column);
      const float dimension = roughness_->dimension(row, column);
      const bool estimated =
          (roughness_->flags(row, column) & fractal::kTooLittleData) == 0 && std::isfinite(dimension + amplitude_m);
      out.dimension_flags(row, column) = roughness_->flags(row, column);
      if (estimated) {
        out.dimension(row, column) = dimension;
        out.dimension_sigma(row, column) = roughness_->dimension_sigma(row, column);
        out.amplitude_m(row, column) = amplitude_m;
        ground.roughness = fractal::FractalLaw{static_cast<double>(dimension), static_cast<double>(amplitude_m)};
      } else {
        ground.roughness = law_;
      }
    }
    ground.slope_rad = out.slope_rad(row, column);
    if (ground.state == CellState::measured) ground.deviation_m = deviation_m_(row, column);
    ground.step_m = out.step_m(row, column);
    out.cost(row, column) = cell_cost(ground, config_.vehicle);
  }
}

}  // namespace scree::mapping
