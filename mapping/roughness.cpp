#include "mapping/roughness.hpp"

#include <limits>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

fractal::DimensionMapConfig mapper_config(const RoughnessConfig& config, int radius_cells) {
  fractal::DimensionMapConfig out;
  out.cell_m = config.cell_m;
  out.radius_cells = radius_cells;
  return out;
}

}  // namespace

Roughness::Roughness(const RoughnessConfig& config)
    : config_(config),
      small_(mapper_config(config, config.small_radius_cells)),
      large_(mapper_config(config, config.large_radius_cells)) {}

// An exact plane has no sigma: the small window is as good as any.
bool Roughness::small_is_certain(int row, int column) const {
  return (small_map_->flags(row, column) & fractal::kTooLittleData) == 0 &&
         !(small_map_->dimension_sigma(row, column) > static_cast<float>(config_.sigma_target));
}

/// Of the rows that stand for blocks, each from the rows of its block.
void Roughness::ask_row(const Grid<std::uint8_t>& wanted, int row) {
  std::fill(asked_.row(row).begin(), asked_.row(row).end(), std::uint8_t{0});
  for (int other = row; other < std::min(row + 2, wanted.rows()); ++other) {
    if (of_block(other, window_.min.y) != row) continue;
    for (int column = 0; column < wanted.columns(); ++column)
      if (wanted(other, column) != 0) asked_(row, of_block(column, window_.min.x)) = 1;
  }
}

void Roughness::ask_large_row(int row) {
  for (int column = 0; column < asked_.columns(); ++column)
    asked_large_(row, column) = static_cast<std::uint8_t>(asked_(row, column) != 0 && !small_is_certain(row, column));
}

void Roughness::choose_row(const Grid<std::uint8_t>& wanted, int row) {
  const int from_row = of_block(row, window_.min.y);
  for (int column = 0; column < map_.flags.columns(); ++column) {
    const int from_column = of_block(column, window_.min.x);
    const bool has_small = (small_map_->flags(from_row, from_column) & fractal::kTooLittleData) == 0;
    const bool has_large = (large_map_->flags(from_row, from_column) & fractal::kTooLittleData) == 0;
    const bool small = small_is_certain(from_row, from_column) || !has_large;
    const fractal::DimensionMap& from = small ? *small_map_ : *large_map_;
    const bool known = wanted(row, column) != 0 && (has_small || has_large);
    map_.dimension(row, column) = known ? from.dimension(from_row, from_column) : kUnknown;
    map_.dimension_sigma(row, column) = known ? from.dimension_sigma(from_row, from_column) : kUnknown;
    map_.amplitude_m(row, column) = known ? from.amplitude_m(from_row, from_column) : kUnknown;
    map_.flags(row, column) = known ? from.flags(from_row, from_column) : std::uint8_t{fractal::kTooLittleData};
    const int radius = small ? config_.small_radius_cells : config_.large_radius_cells;
    map_.radius_cells(row, column) = static_cast<std::uint8_t>(known ? radius : 0);
  }
}

const RoughnessMap& Roughness::update(const LatticeWindow& window, const Grid<float>& height_m,
                                      const Grid<float>& variance_m2, const Grid<std::uint16_t>& support,
                                      const Grid<std::uint8_t>& wanted, Executor& executor) {
  const auto rows = [&](auto&& body) {
    for_rows(executor, window.rows, [&](int begin, int end) {
      for (int row = begin; row < end; ++row) body(row);
    });
  };
  window_ = window;
  for (Grid<std::uint8_t>* grid : {&asked_, &asked_large_}) grid->reshape(window.rows, window.columns);
  rows([&](int row) { ask_row(wanted, row); });
  const bool both = turn_ == 0;
  small_map_ = both || turn_ % 2 == 0 ? &small_.update(window, height_m, variance_m2, support, asked_, executor)
                                      : &small_.follow(window);
  rows([&](int row) { ask_large_row(row); });
  large_map_ = both || turn_ % 2 == 1 ? &large_.update(window, height_m, variance_m2, support, asked_large_, executor)
                                      : &large_.follow(window);
  ++turn_;
  if (map_.flags.rows() != window.rows || map_.flags.columns() != window.columns) {
    for (Grid<float>* grid : {&map_.dimension, &map_.dimension_sigma, &map_.amplitude_m})
      grid->assign(window.rows, window.columns, kUnknown);
    for (Grid<std::uint8_t>* grid : {&map_.flags, &map_.radius_cells}) grid->assign(window.rows, window.columns, 0);
  }
  rows([&](int row) { choose_row(wanted, row); });
  return map_;
}

}  // namespace scree::mapping
