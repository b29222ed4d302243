#include "mapping/cell_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/executor.hpp"

namespace scree::mapping {

CellState cell_state(const CellEvidence& evidence, float drop_margin_m) {
  if (evidence.measured) return CellState::measured;
  const bool crossed = evidence.ceiling_m < std::numeric_limits<float>::infinity();
  if (crossed && evidence.lip_m - evidence.ceiling_m > drop_margin_m) return CellState::possible_drop;
  if (evidence.between_measured && std::isfinite(evidence.filled_mean_m))
    return evidence.filled_mean_m - evidence.ceiling_m > drop_margin_m ? CellState::possible_drop
                                                                       : CellState::reconstructed;
  return crossed || evidence.shadowed ? CellState::occluded : CellState::never_seen;
}

const Grid<std::uint8_t>& CellStates::close(const GroundLayers& ground, Executor& executor) {
  closing_.close(ground.measured, config_.reach_cells, executor, closed_);
  return closed_;
}

void CellStates::classify(const GroundLayers& ground, const fractal::Reconstruction* filled, Executor& executor,
                          Grid<CellState>& state, Grid<float>& elevation_m) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  const int rows = ground.measured.rows();
  const int columns = ground.measured.columns();
  const Grid<float>* expected = filled == nullptr             ? nullptr
                                : filled->free_mean_m.empty() ? &filled->mean_m
                                                              : &filled->free_mean_m;
  state.assign(rows, columns, CellState::never_seen);
  elevation_m.assign(rows, columns, kUnknown);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      for (int column = 0; column < columns; ++column) {
        CellEvidence evidence;
        evidence.measured = ground.measured(row, column) != 0;
        evidence.between_measured = closed_(row, column) != 0;
        evidence.shadowed = ground.shadowed(row, column) != 0;
        evidence.ceiling_m = ground.ceiling_m(row, column);
        evidence.lip_m = ground.lip_m(row, column);
        evidence.filled_mean_m = expected != nullptr ? (*expected)(row, column) : kUnknown;
        const CellState verdict = cell_state(evidence, config_.drop_margin_m);
        state(row, column) = verdict;
        if (verdict == CellState::measured) elevation_m(row, column) = ground.height_m(row, column);
        if (verdict == CellState::reconstructed)
          elevation_m(row, column) = std::min(filled->draws_m.front()(row, column), evidence.ceiling_m);
      }
    }
  });
}

}  // namespace scree::mapping
