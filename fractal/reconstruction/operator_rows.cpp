#include "fractal/reconstruction/operator_rows.hpp"

#include <algorithm>

#include "fractal/reconstruction/stencil_rows.hpp"

namespace scree::fractal {
namespace {

EdgeRows edges_of(const BlendField& prior, int row) {
  return {prior.right.row(row), prior.down.row(row), prior.down.reflected(row - 1)};
}

}  // namespace

void OperatorRows::start(const BlendOperator::Level& level, const PaddedField& x) {
  level_ = &level;
  x_ = &x;
  const auto stride = static_cast<std::size_t>(x.columns()) + 2 * PaddedField::kGhost;
  if (stride > stride_) {
    stride_ = stride;
    inner_.assign(3 * stride, 0.0F);
    laplacian_.assign(3 * stride, 0.0F);
    zeros_.assign(stride, 0.0F);
  }
}

void OperatorRows::fill(int row) {
  const float* around[3] = {x_->reflected(row - 1), x_->row(row), x_->reflected(row + 1)};
  float *l = laplacian(row), *in = inner(row);
  const float *half_w1 = level_->half_w1.row(row), *w2 = level_->prior.w2.row(row);
  const int n = x_->columns();
  if (level_->prior.broken())
    broken_laplacian_rows(around, edges_of(level_->prior, row), half_w1, w2, l, in, n);
  else
    laplacian_rows(around, half_w1, w2, l, in, n);
  in[-1] = in[0];
  in[n] = in[n - 1];
}

void OperatorRows::residual(int row, const float* b, float* out) {
  const int n = x_->columns();
  if (!level_->varies()) {
    const float* around[5];
    for (int k = 0; k < 5; ++k) around[k] = x_->reflected(row - 2 + k);
    return uniform_residual_row(level_->prior.uniform, around, level_->diagonal.row(row), b, out, n);
  }
  if (row == 0) fill(0);
  if (row + 1 < x_->rows()) fill(row + 1);
  const float* around[3] = {inner(std::max(row - 1, 0)), inner(row), inner(std::min(row + 1, x_->rows() - 1))};
  const float *diagonal = level_->diagonal.row(row), *half_w1 = level_->half_w1.row(row);
  if (level_->prior.broken())
    broken_residual_row(around, edges_of(level_->prior, row), diagonal, half_w1, x_->row(row), laplacian(row), b, out,
                        n);
  else
    varying_residual_row(around, diagonal, half_w1, x_->row(row), laplacian(row), b, out, n);
}

}  // namespace scree::fractal
