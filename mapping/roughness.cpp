#include "mapping/roughness.hpp"

#include <cstdlib>
#include <limits>

#include "fractal/plane_scroll.hpp"
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

void Roughness::ask_row(const Grid<std::uint8_t>& wanted, int row) {
  for (int column = 0; column < wanted.columns(); ++column) {
    const auto field = static_cast<unsigned>(window_.min.y + row) + static_cast<unsigned>(window_.min.x + column);
    const bool due = (field + turn_) % 2 == 0 || fresh_(row, column) != 0;
    asked_(row, column) = static_cast<std::uint8_t>(wanted(row, column) != 0 && due ? 1 : 0);
    if (asked_(row, column) != 0) fresh_(row, column) = 0;
  }
}

void Roughness::ask_large_row(int row) {
  for (int column = 0; column < asked_.columns(); ++column)
    if (small_is_certain(row, column)) asked_(row, column) = 0;
}

void Roughness::choose_row(const Grid<std::uint8_t>& wanted, int row) {
  for (int column = 0; column < map_.flags.columns(); ++column) {
    const bool has_small = (small_map_->flags(row, column) & fractal::kTooLittleData) == 0;
    const bool has_large = (large_map_->flags(row, column) & fractal::kTooLittleData) == 0;
    const bool small = small_is_certain(row, column) || !has_large;
    const fractal::DimensionMap& from = small ? *small_map_ : *large_map_;
    const bool known = wanted(row, column) != 0 && (has_small || has_large);
    map_.dimension(row, column) = known ? from.dimension(row, column) : kUnknown;
    map_.dimension_sigma(row, column) = known ? from.dimension_sigma(row, column) : kUnknown;
    map_.amplitude_m(row, column) = known ? from.amplitude_m(row, column) : kUnknown;
    map_.flags(row, column) = known ? from.flags(row, column) : std::uint8_t{fractal::kTooLittleData};
    const int radius = small ? config_.small_radius_cells : config_.large_radius_cells;
    map_.radius_cells(row, column) = static_cast<std::uint8_t>(known ? radius : 0);
  }
}

void Roughness::move_to(const LatticeWindow& window) {
  const std::int64_t down = std::int64_t{window.min.y} - window_.min.y,
                     right = std::int64_t{window.min.x} - window_.min.x;
  const bool overlap = window.rows == window_.rows && window.columns == window_.columns &&
                       std::abs(down) < window.rows && std::abs(right) < window.columns;
  window_ = window;
  ++turn_;
  asked_.assign(window.rows, window.columns, 0);
  if (!overlap) return fresh_.assign(window.rows, window.columns, 1);
  fractal::scroll_plane([&](int r) { return fresh_.row(r).data(); }, window.rows, window.columns,
                        static_cast<int>(down), static_cast<int>(right), std::uint8_t{1});
}

const RoughnessMap& Roughness::update(const LatticeWindow& window, const Grid<float>& height_m,
                                      const Grid<float>& variance_m2, const Grid<std::uint16_t>& support,
                                      const Grid<std::uint8_t>& wanted, Executor& executor) {
  move_to(window);
  const auto rows = [&](auto&& body) {
    for_rows(executor, window.rows, [&](int begin, int end) {
      for (int row = begin; row < end; ++row) body(row);
    });
  };
  rows([&](int row) { ask_row(wanted, row); });
  small_map_ = &small_.update(window, height_m, variance_m2, support, asked_, executor);
  rows([&](int row) { ask_large_row(row); });
  large_map_ = &large_.update(window, height_m, variance_m2, support, asked_, executor);
  if (map_.flags.rows() != window.rows || map_.flags.columns() != window.columns) {
    for (Grid<float>* grid : {&map_.dimension, &map_.dimension_sigma, &map_.amplitude_m})
      grid->assign(window.rows, window.columns, kUnknown);
    for (Grid<std::uint8_t>* grid : {&map_.flags, &map_.radius_cells}) grid->assign(window.rows, window.columns, 0);
  }
  rows([&](int row) { choose_row(wanted, row); });
  return map_;
}

}  // namespace scree::mapping
