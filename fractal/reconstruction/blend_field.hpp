#pragma once
// The blend prior of a grid of cells: one pair of weights for all, or one a cell, and how firmly neighbours hold
// together.

#include "fractal/reconstruction/blend_prior.hpp"
#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// Energy ½ Σ_edges e·½(w1_i + w1_j)·(u_i − u_j)² + ½ Σ_cells w2_i·(L_e u)_i², (L_e u)_i = Σ_j e_ij·(u_i − u_j):
/// heights enter by differences only, so constants cost nothing whatever the weights. With equal weights and all e = 1
/// it is ½ u'(w1·L + w2·L²)u.
struct BlendField {
  BlendWeights uniform;  ///< of every cell where w1 and w2 are empty
  PaddedField w1, w2;    ///< both empty, or of the grid's shape; > 0
  /// Factors e of the edges, [0.02, 1] for breaks, or both empty for 1 everywhere: right(r, c) joins (r, c) and
  /// (r, c + 1), down(r, c) joins (r, c) and (r + 1, c). What lies on the border (right of the last column, below the
  /// last row) is read and has no effect; it must be finite.
  PaddedField right, down;

  bool varies() const { return w1.rows() > 0; }
  bool broken() const { return right.rows() > 0; }
};

/// The same prior on cells twice as large, rows and columns even: weights are means of the four, w2 over 4 (a stencil
/// of fourth order on a doubled step against one of second); an edge is the series of the half cells and the face it
/// crosses, side by side twice.
void coarsen(const BlendField& fine, BlendField& coarse);

}  // namespace scree::fractal
