#pragma once
// Where the surface may break.

#include <array>
#include <span>

#include "core/grid.hpp"
#include "fractal/reconstruction/blend_fit.hpp"

namespace scree::fractal {

struct LineProcessOptions {
  std::array<double, 3> steps = {6.0, 4.0, 3.0};  ///< τ of each reweighting, in changes over one cell
  double least = 0.02;                            ///< what is left of an edge
  double tolerance = 0.002;  ///< of the solves: the V-cycle underestimates the modes that a break makes soft
};

/// Geman and McClure's energy of the differences du between neighbours, by reweighting: an edge's factor becomes
/// e = max(least, (1 + (du/τ)²)^−2), its surface is solved for again, and τ shrinks from step to step so that the edges
/// gather where the largest differences are. `fit` holds data, weights and the solution without breaks, and afterwards
/// edges and the solution with them. `change`: of the ground over one cell, in the fit's units; empty = 1 everywhere.
/// Cost: one solve a step, some 10–20 cycles each. Source: [GM87] for the energy, [BR96] for edges as its dual.
void break_edges(BlendFit& fit, const Grid<float>& change, const LineProcessOptions& options = {});

}  // namespace scree::fractal
