#include "mapping/ground_layers.hpp"

#include <limits>

#include "core/executor.hpp"

namespace scree::mapping {

void GroundLayers::shape(int rows, int columns) {
  if (height_m.rows() == rows && height_m.columns() == columns) return;
  for (Grid<float>* grid : {&height_m, &noise_variance_m2, &variance_m2, &relief_m2, &ceiling_m, &lip_m, &cell_age_s})
    grid->assign(rows, columns, 0.0F);
  hits.assign(rows, columns, 0);
  support.assign(rows, columns, 0);
  measured.assign(rows, columns, 0);
  shadowed.assign(rows, columns, 0);
}

void GroundLayers::unroll(const RollingGrid<MapCell>& map, double cell_m, Executor& executor, std::uint32_t now_ms) {
  const LatticeWindow& window = map.window();
  shape(window.rows, window.columns);
  const auto pitch_m = static_cast<float>(cell_m);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      int column = 0;
      for (const auto piece : map.row_pieces(row)) {
        for (const MapCell& cell : piece) {
          const bool known = cell.measured();
          height_m(row, column) = known ? cell.height_m : std::numeric_limits<float>::quiet_NaN();
          noise_variance_m2(row, column) = known ? cell.noise_variance_m2 : 0.0F;
          variance_m2(row, column) = known ? height_variance_m2(cell, pitch_m) : 0.0F;
          relief_m2(row, column) = known ? cell.relief_m2 : 0.0F;
          ceiling_m(row, column) = cell.ceiling_m;
          lip_m(row, column) = cell.lip_m;
          cell_age_s(row, column) = known ? age_s(now_ms, cell.fused_ms) : std::numeric_limits<float>::quiet_NaN();
          hits(row, column) = cell.hits;
          support(row, column) = random_support(cell.hits);
          measured(row, column) = known ? 1 : 0;
          shadowed(row, column) = cell.shadowed ? 1 : 0;
          ++column;
        }
      }
    }
  });
}

void GroundLayers::judge_variance(const RollingGrid<MapCell>& map, const Grid<float>& relief_m2_by_law,
                                  Executor& executor) {
  for_rows(executor, measured.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < measured.columns(); ++column) {
        if (measured(row, column) == 0) continue;
        const MapCell& cell = map(row, column);
        variance_m2(row, column) =
            cell.shared_variance_m2 + height_variance_of_relief_m2(cell.noise_variance_m2, cell.place_variance_m2,
                                                                   cell.relief_m2, cell.hits,
                                                                   relief_m2_by_law(row, column));
      }
  });
}

}  // namespace scree::mapping
