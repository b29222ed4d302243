#include "mapping/layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

RoughnessConfig roughness_config(const MapConfig& config) {
  return {config.cell_m, config.dimension_small_radius_cells, config.dimension_radius_cells,
          config.dimension_sigma_target};
}

LocalElevationConfig elevation_config(const MapConfig& config) {
  return {config.cell_m, config.size_cells, config.draws, config.seed};
}

RiskConfig risk_config(const MapConfig& config) {
  return {config.cell_m, config.headings, config.vehicle};
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

// A face that its returns sample evenly is √12 of their standard deviations high. What the law expects of the relief of
// a cell, three times over, and what chance adds to it, are no face: the cells' own heights show that ground's steps.
constexpr float kFaceVariances = 12.0F;
constexpr float kExpectedRelief = 3.0F;
constexpr float kChance = 3.0F;  // standard deviations of a sample variance

float face_m2(float relief_m2, float expected_m2, float noise_m2, float hits) {
  const float chance = kChance * std::sqrt(2.0F / std::max(hits, 1.0F)) * (noise_m2 + expected_m2);
  return kFaceVariances * std::max(0.0F, relief_m2 - kExpectedRelief * expected_m2 - chance);
}

}  // namespace

Layers::Layers(const MapConfig& config)
    : config_(config),
      roughness_(roughness_config(config)),
      states_(state_config(config)),
      law_field_(config.cell_m),
      elevation_(elevation_config(config)),
      shape_(shape_config(config)),
      footprint_risk_(risk_config(config)) {}

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
  rough_ = &roughness_.update(window, ground_.height_m, place_variance_m2_, ground_.support, *closed_, executor);
}

fractal::Reconstruction* Layers::reconstruct(const RollingGrid<MapCell>& map, Executor& executor) {
  const LatticeWindow& window = map.window();
  const auto seen = window_law_.estimate(*rough_, ground_.measured);
  if (seen) law_ = law_ ? follow(*law_, *seen) : *seen;
  if (!law_) return nullptr;
  law_field_.update(window, *rough_, *law_, ground_, executor);
  ground_.judge_variance(map, law_field_.relief_m2(), executor);
  return elevation_.update(ground_, window, law_field_.law(), *closed_, executor);
}

void Layers::judge_risk(const fractal::Reconstruction& filled, const Grid<CellState>& state, Executor& executor) {
  const int rows = closed_->rows(), columns = closed_->columns();
  face_m2_.reshape(rows, columns);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < columns; ++column) {
        const auto hits = static_cast<float>(ground_.hits(row, column));
        face_m2_(row, column) = face_m2(ground_.relief_m2(row, column), law_field_.relief_m2()(row, column),
                                        hits * ground_.noise_variance_m2(row, column), hits);
      }
  });
  footprint_risk_.update(filled.draws_m, {law_field_.relief_m2(), face_m2_, state}, *closed_, executor, risk_);
}

void Layers::shape_outputs(MapSnapshot& out) const {
  const int rows = out.window.rows, columns = out.window.columns;
  for (Grid<float>* grid : {&out.elevation_mean_m, &out.elevation_sigma_m, &out.dimension, &out.dimension_sigma,
                            &out.amplitude_m, &out.risk})
    grid->assign(rows, columns, kUnknown);
  out.cost.assign(rows, columns, kCostUnknown);
  out.hits.assign(rows, columns, 0);
  out.dimension_radius_cells.assign(rows, columns, 0);
  out.dimension_flags.assign(rows, columns, fractal::kTooLittleData);
}

void Layers::compute(RollingGrid<MapCell>& map, std::uint32_t now_ms, Executor& executor, StageClock& clock,
                     MapSnapshot& out) {
  const LatticeWindow& window = map.window();
  ground_.unroll(map, config_.cell_m, executor, now_ms);
  out.cell_age_s = ground_.cell_age_s;
  closed_ = &states_.close(ground_, executor);
  estimate_roughness(window, executor);
  clock.lap(Stage::roughness);
  fractal::Reconstruction* filled = reconstruct(map, executor);
  clock.lap(Stage::elevation);
  states_.classify(ground_, filled, executor, out.state, out.elevation_m);
  shape_.update(out.elevation_m, ground_.noise_variance_m2, ground_.relief_m2, executor, out.slope_rad, out.step_m);
  clock.lap(Stage::shape);
  if (filled != nullptr) judge_risk(*filled, out.state, executor);
  clock.lap(Stage::risk);
  shape_outputs(out);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) publish_row(row, filled, map, out);
  });
  hand_over(filled, out);
  clock.lap(Stage::publish);
}

/// The snapshot's old buffers become the next frame's.
void Layers::hand_over(fractal::Reconstruction* filled, MapSnapshot& out) {
  if (filled == nullptr) {
    out.draws_m.clear();
    out.heading_risk.clear();
    return;
  }
  std::swap(out.draws_m, filled->draws_m);
  std::swap(out.heading_risk, risk_.sector);
}

/// What a scanner does not see of rough ground it does not see of the neighbours either: no noise of single heights
/// that a reconstruction could smooth away, but part of every height's error.
float Layers::sigma_m(int row, int column, const fractal::Reconstruction* filled) const {
  const float hidden_m2 = filled != nullptr ? law_field_.hidden_m2()(row, column) : 0.0F;
  if (ground_.measured(row, column) != 0) return std::sqrt(ground_.variance_m2(row, column) + hidden_m2);
  const float sd_m = filled->sd_m(row, column);
  return std::sqrt(sd_m * sd_m + hidden_m2);
}

void Layers::publish_row(int row, const fractal::Reconstruction* filled, RollingGrid<MapCell>& map, MapSnapshot& out) {
  for (int column = 0; column < out.window.columns; ++column) {
    CellRisk cell;
    cell.state = out.state(row, column);
    cell.risk = cell.tail = kUnknown;
    out.hits(row, column) = ground_.hits(row, column);
    const bool measured = cell.state == CellState::measured;
    if (measured || cell.state == CellState::reconstructed) {
      out.elevation_mean_m(row, column) = measured ? ground_.height_m(row, column) : filled->mean_m(row, column);
      out.elevation_sigma_m(row, column) = sigma_m(row, column, filled);
      out.dimension(row, column) = rough_->dimension(row, column);
      out.dimension_sigma(row, column) = rough_->dimension_sigma(row, column);
      out.amplitude_m(row, column) = rough_->amplitude_m(row, column);
      out.dimension_flags(row, column) = rough_->flags(row, column);
      out.dimension_radius_cells(row, column) = rough_->radius_cells(row, column);
      cell.roughness_known = std::isfinite(rough_->dimension(row, column));
    }
    if (filled != nullptr && (measured || cell.state == CellState::reconstructed)) {
      cell.risk = out.risk(row, column) = risk_.worst(row, column);
      cell.tail = risk_.tail(row, column);
      cell.on_unknown = risk_.on_unknown(row, column) > 0.0F;
    }
    out.cost(row, column) = guarded_cost(cell.state, cell_cost(cell, config_.cost), map(row, column).lethal);
  }
}

}  // namespace scree::mapping
