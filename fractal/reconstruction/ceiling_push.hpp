#pragma once
// Samples of the surface that rays passed over.

#include <cstdint>

#include "core/grid.hpp"
#include "fractal/reconstruction/blend_solver.hpp"

namespace scree::fractal {

struct CeilingOptions {
  double gain = 1.5;       ///< g: how far below the ceiling for each unit above it
  double margin = 0.3;     ///< in changes over one cell
  double precision = 0.3;  ///< of a push, in inverse squares of that change
  int rounds = 3;
};

/// A ray says that the ground is below it. A sample that is not is pushed: each cell above its ceiling gets a datum of
/// its own at ceiling − g·(height − ceiling) − margin, a reflection, so that the cell keeps a spread below the ceiling
/// instead of a heap at it; the sample's correction δ, (A + P)·δ = P·(target − sample), spreads by the prior to where
/// no ray passed. Cells that are then above join, `rounds` times. Not a posterior given the rays (that would need
/// rejection), an approximation that measures well: docs/reconstruction.md.
class CeilingPush {
 public:
  explicit CeilingPush(const CeilingOptions& options = {}) : options_(options) {}

  /// `sample` in units of the change over one cell, changed in place; `ceiling` in the same unit and from the same
  /// level, NaN or +inf = none (at measured cells too), of the map's shape; `prior` and `precision` as in the sample's
  /// solve; `change`: local change over a cell in that unit, empty = 1. Returns false when nothing was above.
  bool apply(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision,
             const Grid<float>& ceiling, const Grid<float>& change, double tolerance, int max_iterations,
             PaddedField& sample);

  /// One round for ground that is looked at frame after frame: `delta` holds the push of the last frame (0 = none) and
  /// receives this one's. Cells above their ceiling with or without it get a datum. `sample` stays as it is. Returns
  /// false when nothing was above; `delta` is then 0. No allocation when the shape stays.
  bool follow(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision,
              const Grid<float>& ceiling, const Grid<float>& change, double tolerance, int max_iterations,
              const PaddedField& sample, PaddedField& delta);

  /// What the last apply() added; zero where it returned false.
  const PaddedField& delta() const { return delta_; }
  int iterations() const { return iterations_; }  ///< of all solves
  bool converged() const { return converged_; }   ///< all of them

 private:
  int activate(const PaddedField& precision, const Grid<float>& ceiling, const Grid<float>& change,
               const PaddedField& sample, const PaddedField& delta);

  CeilingOptions options_;
  BlendOperator matrix_;
  BlendSolver solver_;
  PaddedField total_, right_side_, delta_;
  Grid<std::uint8_t> active_;
  int iterations_ = 0;
  bool converged_ = true;
};

}  // namespace scree::fractal
