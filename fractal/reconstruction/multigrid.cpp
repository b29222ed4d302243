#include "fractal/reconstruction/multigrid.hpp"

#include <algorithm>

#include "core/simd.hpp"
#include "fractal/reconstruction/stencil_rows.hpp"

namespace scree::fractal {
namespace {

/// Into the level's transfer and step, from c in its diagonal.
void uniform_smoother(BlendOperator::Level& level) {
  const BlendWeights w = level.prior.uniform;
  const float d0 = 4 * w.w1 + 20 * w.w2, largest = 8 * w.w1 + 64 * w.w2;  // largest: at the chequerboard
  level.step_factor = 4.0F / (3.0F * largest);
  for (int r = 0; r < level.diagonal.rows(); ++r) {
    const float* c = level.diagonal.row(r);
    float* s = level.transfer.row(r);
    for (int i = 0; i < level.diagonal.columns(); ++i) s[i] = d0 / (d0 + c[i]);
  }
}

/// A cell's four neighbours: factor of the edge, weights.
struct Neighbour {
  float e, w1, w2;
};

struct Neighbourhood {
  Neighbour sides[4];

  Neighbourhood(const BlendField& p, int r, int c) {
    const float* w1[3] = {p.w1.reflected(r - 1), p.w1.row(r), p.w1.reflected(r + 1)};
    const float* w2[3] = {p.w2.reflected(r - 1), p.w2.row(r), p.w2.reflected(r + 1)};
    sides[0] = {p.right.row(r)[c], w1[1][c + 1], w2[1][c + 1]};
    sides[1] = {p.right.row(r)[c - 1], w1[1][c - 1], w2[1][c - 1]};
    sides[2] = {p.down.row(r)[c], w1[2][c], w2[2][c]};
    sides[3] = {p.down.reflected(r - 1)[c], w1[0][c], w2[0][c]};
  }
};

/// The rows of a weight around a row.
struct WeightRows {
  const float *up, *mid, *down;
  WeightRows(const PaddedField& w, int r) : up(w.reflected(r - 1)), mid(w.row(r)), down(w.reflected(r + 1)) {}
};

/// The same of weights of each cell, whole edges: d0 = 2 w1 + ½ Σ w1 + 16 w2 + Σ w2 over the neighbours.
SCREE_CLONES void varying_row(const WeightRows& a, const WeightRows& b, const float* __restrict c,
                              float* __restrict transfer, float* __restrict step, float* __restrict half, int n) {
  for (int i = 0; i < n; ++i) {
    const float w1 = a.mid[i], w2 = b.mid[i];
    const float n1 = (a.mid[i - 1] + a.mid[i + 1]) + (a.up[i] + a.down[i]);
    const float n2 = (b.mid[i - 1] + b.mid[i + 1]) + (b.up[i] + b.down[i]);
    const float d0 = 2.0F * w1 + 0.5F * n1 + 16.0F * w2 + n2;
    const float l1 = 4.0F * w1 + n1 + 32.0F * w2 + 8.0F * n2;
    const float s = d0 / (d0 + c[i]);
    transfer[i] = s;
    step[i] = 4.0F / (3.0F * l1) * s;
    half[i] = 0.5F * w1;
  }
}
SCREE_CLONES void varying_diagonal_row(const WeightRows& a, float* __restrict c, int n) {
  for (int i = 0; i < n; ++i)
    c[i] -= 0.5F * (4.0F * a.mid[i] - ((a.mid[i - 1] + a.mid[i + 1]) + (a.up[i] + a.down[i])));
}

/// The same where edges may be broken.
void broken_smoother(BlendOperator::Level& level) {
  const BlendField& prior = level.prior;
  const auto sum_of_edges = [&prior](int r, int c) {
    return (prior.right.row(r)[c] + prior.right.row(r)[c - 1]) +
           (prior.down.row(r)[c] + prior.down.reflected(r - 1)[c]);
  };
  for (int r = 0; r < level.diagonal.rows(); ++r) {
    const float* c = level.diagonal.row(r);
    float *s = level.transfer.row(r), *step = level.step.row(r);
    const float *w1 = prior.w1.row(r), *w2 = prior.w2.row(r);
    float* half = level.half_w1.row(r);
    for (int i = 0; i < level.diagonal.columns(); ++i) {
      const Neighbourhood around(prior, r, i);
      const float edges = sum_of_edges(r, i);
      float flux = 0.0F, bend = w2[i] * edges * edges, bend_sum = 2.0F * bend;
      for (const Neighbour& n : around.sides) {
        flux += n.e * 0.5F * (w1[i] + n.w1);
        bend += n.e * n.e * n.w2;
        bend_sum += n.e * n.w2 * 8.0F;  // 2·(sum of the neighbour's edges), at most
      }
      const float d0 = flux + bend, l1 = 2.0F * flux + bend_sum;
      s[i] = d0 / (d0 + c[i]);
      step[i] = 4.0F / (3.0F * l1) * s[i];
      half[i] = 0.5F * w1[i];
    }
  }
}

void varying_smoother(BlendOperator::Level& level) {
  if (level.prior.broken()) return broken_smoother(level);
  for (int r = 0; r < level.diagonal.rows(); ++r)
    varying_row({level.prior.w1, r}, {level.prior.w2, r}, level.diagonal.row(r), level.transfer.row(r),
                level.step.row(r), level.half_w1.row(r), level.diagonal.columns());
}

/// Turns c in the diagonal into c − ½·L_e·w1.
void varying_diagonal(BlendOperator::Level& level) {
  const int columns = level.diagonal.columns();
  for (int r = 0; r < level.diagonal.rows(); ++r) {
    const float* w1 = level.prior.w1.row(r);
    float* c = level.diagonal.row(r);
    if (!level.prior.broken()) {
      varying_diagonal_row({level.prior.w1, r}, c, columns);
      continue;
    }
    for (int i = 0; i < columns; ++i)
      for (const Neighbour& n : Neighbourhood(level.prior, r, i).sides) c[i] -= 0.5F * n.e * (w1[i] - n.w1);
  }
}

void fill(PaddedField& field, int rows, int columns, float value) {
  field.resize(rows, columns);
  for (int r = 0; r < rows; ++r) {
    std::fill_n(field.row(r), columns, value);
    field.reflect_columns(r);
  }
}

}  // namespace

MultigridShape::MultigridShape(int window_rows, int window_columns) {
  int shorter = std::max(4, std::min(window_rows, window_columns));
  int longer = std::max(4, std::max(window_rows, window_columns));
  for (; shorter > 16 || (longer > 32 && shorter > 6); ++levels) {
    shorter = (shorter + 1) / 2;
    longer = (longer + 1) / 2;
  }
  // One level more where it costs no margin: a direct solve of 16 × 16 cells is a tenth of a cycle at 256 × 256.
  const int unit = 1 << levels;
  const auto padded = [unit](int side) { return (std::max(side, 4) + unit - 1) / unit * unit; };
  rows = padded(window_rows);
  columns = padded(window_columns);
  if (shorter > 8 && rows % (2 * unit) == 0 && columns % (2 * unit) == 0) ++levels;
}

void BlendOperator::set_up(const MultigridShape& shape, BlendWeights weights, const PaddedField& precision) {
  BlendField prior;
  prior.uniform = weights;
  set_up(shape, prior, precision);
}

void BlendOperator::set_up(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision) {
  levels_.resize(static_cast<std::size_t>(shape.levels) + 1);
  BlendField& finest = levels_.front().prior;
  finest = prior;
  if (finest.broken() && !finest.varies()) {
    fill(finest.w1, shape.rows, shape.columns, prior.uniform.w1);
    fill(finest.w2, shape.rows, shape.columns, prior.uniform.w2);
  }
  for (PaddedField* field : {&finest.w1, &finest.w2, &finest.right, &finest.down})
    for (int r = 0; r < field->rows(); ++r) field->reflect_columns(r);
  set_up_levels(shape, precision);
}

/// c of the next level, 0.7·P'(S·c), from c in the fine level's diagonal.
void BlendOperator::coarse_precision(const Level& fine, PaddedField& coarse) {
  const PaddedField& c = fine.diagonal;
  const auto n = static_cast<std::size_t>(c.columns());
  ring_.resize(4 * n);
  line_.resize(n + 2);
  for (int j = 0; j < coarse.rows(); ++j) {
    const float* rows[4];
    for (int k = 0; k < 4; ++k) {
      const int row = std::clamp(2 * j - 1 + k, 0, c.rows() - 1);
      float* product = ring_.data() + static_cast<std::size_t>(k) * n;
      scaled_product_row(0.7F, c.row(row), fine.transfer.row(row), product, c.columns());
      rows[k] = product;
    }
    restrict_row(rows, line_.data(), coarse.row(j), coarse.columns());
  }
}

void BlendOperator::set_up_levels(const MultigridShape& shape, const PaddedField& precision) {
  levels_.front().diagonal = precision;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    const int rows = shape.rows >> l, columns = shape.columns >> l;
    for (PaddedField* field : {&level.diagonal, &level.transfer}) field->reshape(rows, columns);
    if (l > 0) {
      coarsen(levels_[l - 1].prior, level.prior);
      coarse_precision(levels_[l - 1], level.diagonal);
      if (levels_[l - 1].varies()) varying_diagonal(levels_[l - 1]);
    }
    if (!level.varies()) {
      uniform_smoother(level);
      continue;
    }
    for (PaddedField* field : {&level.step, &level.half_w1}) field->reshape(rows, columns);
    varying_smoother(level);
  }
  coarsest_.factor(levels_.back().prior, levels_.back().diagonal);
  if (levels_.back().varies()) varying_diagonal(levels_.back());
}

}  // namespace scree::fractal
