#pragma once
// The arithmetic of the solver, a row at a time. Rows are those of PaddedField: two valid cells beyond either end where
// a kernel looks sideways. Pointers named `out` overlap no input.

#include "fractal/reconstruction/blend_prior.hpp"

namespace scree::fractal {

/// out = b − (w1·L + w2·L² + diag c)·x by the 13-point stencil; x: the five rows around.
void uniform_residual_row(BlendWeights weights, const float* const* x, const float* c, const float* b, float* out,
                          int n);

/// Rows of L·x and of what is to be differenced again, half_w1·x + w2·(L·x); x: the three rows around.
void laplacian_rows(const float* const* x, const float* half_w1, const float* w2, float* laplacian, float* inner,
                    int n);
/// out = b − (diagonal·x + half_w1·(L·x) + L·inner); inner: the three rows around.
void varying_residual_row(const float* const* inner, const float* diagonal, const float* half_w1, const float* x,
                          const float* laplacian, const float* b, float* out, int n);

/// Factors of the edges of one row: to the right of each cell, below it, and below the cell above.
struct EdgeRows {
  const float *right, *down, *up;
};
/// The same with L_e in place of L.
void broken_laplacian_rows(const float* const* x, const EdgeRows& edges, const float* half_w1, const float* w2,
                           float* laplacian, float* inner, int n);
void broken_residual_row(const float* const* inner, const EdgeRows& edges, const float* diagonal, const float* half_w1,
                         const float* x, const float* laplacian, const float* b, float* out, int n);

/// out = factor·a·b
void scaled_product_row(float factor, const float* a, const float* b, float* out, int n);
/// x += α·p, r += α·q, z = factor·step·r
void advance_row(float alpha, const float* p, const float* q, float factor, const float* step, float* x, float* r,
                 float* z, int n);
/// out = z + factor·step·residual; returns Σ r·out.
double correct_row(float factor, const float* step, const float* residual, const float* z, const float* r, float* out,
                   int n);
/// p = z + β·p
void direction_row(float beta, const float* z, float* p, int n);
double dot_row(const float* a, const float* b, int n);

/// out[j] = Σ weights 1 3 3 1 down and across /16 of the four rows around coarse row; n coarse columns. `line` is
/// scratch of 2n + 2.
void restrict_row(const float* const* fine, float* line, float* out, int n);
/// fine += transfer·(¾ and ¼ of the two rows, then of the columns); n coarse columns, one valid cell beyond either end.
/// `line` is scratch of 3n + 2.
void prolong_row(const float* near, const float* away, const float* transfer, float* line, float* fine, int n);

}  // namespace scree::fractal
