#include <algorithm>

#include "core/simd.hpp"
#include "tests/bench/reconstruction/plain_solver.hpp"

namespace scree::bench::plain {
using namespace fractal;
namespace {

struct Stencil {
  float centre, side, diagonal, far;
  explicit Stencil(BlendWeights w)
      : centre(4 * w.w1 + 20 * w.w2), side(-w.w1 - 8 * w.w2), diagonal(2 * w.w2), far(w.w2) {}
  /// Largest eigenvalue of the prior part (at the chequerboard).
  static float largest(BlendWeights w) { return 8 * w.w1 + 64 * w.w2; }
};

/// out = b − A·x on one row; x holds the rows −2 … 2 around it.
SCREE_CLONES void residual_row(const Stencil& a, const float* const* x, const float* c, const float* b, float* out,
                               int n) {
  const float* __restrict up2 = x[0], * __restrict up = x[1], * __restrict mid = x[2], * __restrict down = x[3], * __restrict down2 = x[4];
  const float centre = a.centre, side = a.side, diagonal = a.diagonal, far = a.far;
  for (int i = 0; i < n; ++i) {
    const float sides = (mid[i - 1] + mid[i + 1]) + (up[i] + down[i]);
    const float diagonals = (up[i - 1] + up[i + 1]) + (down[i - 1] + down[i + 1]);
    const float fars = (mid[i - 2] + mid[i + 2]) + (up2[i] + down2[i]);
    out[i] = b[i] - ((centre + c[i]) * mid[i] + side * sides + diagonal * diagonals + far * fars);
  }
}

SCREE_CLONES void multiply_row(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] * b[i];
}

SCREE_CLONES void add_product_row(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] += a[i] * b[i];
}

/// line[i] = (1·r0 + 3·r1 + 3·r2 + 1·r3) of values times their transfer weights.
SCREE_CLONES void gather_rows(const float* const* t, const float* const* s, float* __restrict line, int n) {
  for (int i = 0; i < n; ++i)
    line[i] = (t[0][i] * s[0][i] + t[3][i] * s[3][i]) + 3.0F * (t[1][i] * s[1][i] + t[2][i] * s[2][i]);
}

/// coarse = P'(S·fine), summing: each fine cell hands out its whole value.
void restrict_to(const PaddedField& fine, const PaddedField& transfer, std::vector<float>& line, PaddedField& coarse) {
  const int n = fine.columns();
  line.resize(static_cast<std::size_t>(n) + 2);
  float* centre = line.data() + 1;
  for (int row = 0; row < coarse.rows(); ++row) {
    const float *t[4], *s[4];
    for (int k = 0; k < 4; ++k) {
      t[k] = fine.reflected(2 * row - 1 + k);
      s[k] = transfer.reflected(2 * row - 1 + k);
    }
    gather_rows(t, s, centre, n);
    centre[-1] = centre[0];
    centre[n] = centre[n - 1];
    float* out = coarse.row(row);
    for (int j = 0; j < coarse.columns(); ++j)
      out[j] = (1.0F / 16.0F) * ((centre[2 * j - 1] + centre[2 * j + 2]) + 3.0F * (centre[2 * j] + centre[2 * j + 1]));
  }
}

SCREE_CLONES void blend_rows(const float* near, const float* away, float* __restrict line, int n) {
  for (int i = 0; i < n; ++i) line[i] = 0.75F * near[i] + 0.25F * away[i];
}

/// fine += S·P·coarse; the ghost columns of coarse must be current.
void add_prolonged(const PaddedField& coarse, const PaddedField& transfer, std::vector<float>& line,
                   PaddedField& fine) {
  const int n = coarse.columns();
  line.resize(static_cast<std::size_t>(n) + 2 + static_cast<std::size_t>(fine.columns()));
  float* centre = line.data() + 1;
  float* spread = line.data() + n + 2;
  for (int row = 0; row < fine.rows(); ++row) {
    const int near = row / 2, away = row % 2 ? near + 1 : near - 1;
    blend_rows(coarse.row(near) - 1, coarse.reflected(away) - 1, centre - 1, n + 2);
    for (int j = 0; j < n; ++j) {
      spread[2 * j] = 0.75F * centre[j] + 0.25F * centre[j - 1];
      spread[2 * j + 1] = 0.75F * centre[j] + 0.25F * centre[j + 1];
    }
    add_product_row(transfer.row(row), spread, fine.row(row), fine.columns());
  }
}

void reflect_all_columns(PaddedField& field) {
  for (int r = 0; r < field.rows(); ++r) field.reflect_columns(r);
}

void resize_if_needed(PaddedField& field, int rows, int columns) {
  if (field.rows() != rows || field.columns() != columns) field.resize(rows, columns);
}

}  // namespace

void BlendOperator::set_up(const MultigridShape& shape, BlendWeights weights, const PaddedField& precision) {
  levels_.resize(static_cast<std::size_t>(shape.levels) + 1);
  std::vector<float>& line = coarse_precision_;  // scratch until the coarsest level needs it
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    const int rows = shape.rows >> l, columns = shape.columns >> l;
    for (PaddedField* field : {&level.precision, &level.step, &level.transfer}) resize_if_needed(*field, rows, columns);
    level.weights = {weights.w1, l == 0 ? weights.w2 : levels_[l - 1].weights.w2 / 4.0F};
    if (l == 0) {
      level.precision = precision;
    } else {
      restrict_to(levels_[l - 1].precision, levels_[l - 1].transfer, line, level.precision);
    }
    const float d0 = Stencil(level.weights).centre, step = 4.0F * d0 / (3.0F * Stencil::largest(level.weights));
    for (int r = 0; r < rows; ++r) {
      float *c = level.precision.row(r), *s = level.step.row(r), *t = level.transfer.row(r);
      const float lumping = l == 0 ? 1.0F : 0.7F;
      for (int i = 0; i < columns; ++i) {
        c[i] *= lumping;
        t[i] = d0 / (d0 + c[i]);
        s[i] = step / (d0 + c[i]);
      }
      level.transfer.reflect_columns(r);
    }
  }
  BlendField prior;
  prior.uniform = levels_.back().weights;
  coarsest_.factor(prior, levels_.back().precision);
}

void BlendOperator::residual(const Level& level, const PaddedField& x, const PaddedField& b, PaddedField& out) {
  const Stencil stencil(level.weights);
  for (int r = 0; r < x.rows(); ++r) {
    const float* around[5];
    for (int k = 0; k < 5; ++k) around[k] = x.reflected(r - 2 + k);
    residual_row(stencil, around, level.precision.row(r), b.row(r), out.row(r), x.columns());
  }
}

void VCycle::resize(const BlendOperator& matrix) {
  buffers_.resize(matrix.levels().size());
  for (std::size_t l = 0; l < buffers_.size(); ++l) {
    const PaddedField& shape = matrix.levels()[l].precision;
    for (PaddedField* field : {&buffers_[l].x, &buffers_[l].b, &buffers_[l].t})
      resize_if_needed(*field, shape.rows(), shape.columns());
  }
}

void VCycle::apply(const BlendOperator& matrix, const PaddedField& r, PaddedField& z) {
  descend(matrix, 0, r, z);
}

void VCycle::descend(const BlendOperator& matrix, std::size_t level, const PaddedField& b, PaddedField& x) {
  if (level + 1 == matrix.levels().size()) return solve_coarsest(matrix, b, x);
  const BlendOperator::Level& here = matrix.levels()[level];
  PaddedField& t = buffers_[level].t;
  for (int r = 0; r < x.rows(); ++r) {
    multiply_row(here.step.row(r), b.row(r), x.row(r), x.columns());
    x.reflect_columns(r);
  }
  BlendOperator::residual(here, x, b, t);
  restrict_to(t, here.transfer, line_, buffers_[level + 1].b);
  descend(matrix, level + 1, buffers_[level + 1].b, buffers_[level + 1].x);
  add_prolonged(buffers_[level + 1].x, here.transfer, line_, x);
  reflect_all_columns(x);
  BlendOperator::residual(here, x, b, t);
  for (int r = 0; r < x.rows(); ++r) {
    add_product_row(here.step.row(r), t.row(r), x.row(r), x.columns());
    x.reflect_columns(r);
  }
}

void VCycle::solve_coarsest(const BlendOperator& matrix, const PaddedField& b, PaddedField& x) {
  direct_.clear();
  for (int r = 0; r < b.rows(); ++r) direct_.insert(direct_.end(), b.row(r), b.row(r) + b.columns());
  matrix.coarsest().solve(direct_, direct_work_);
  auto from = direct_.cbegin();
  for (int r = 0; r < x.rows(); ++r) {
    for (int c = 0; c < x.columns(); ++c) x.row(r)[c] = static_cast<float>(*from++);
    x.reflect_columns(r);
  }
}

}  // namespace scree::bench::plain
