#include "fractal/reconstruction/v_cycle.hpp"

#include <algorithm>

#include "fractal/reconstruction/stencil_rows.hpp"

namespace scree::fractal {

void VCycle::resize(const BlendOperator& matrix) {
  buffers_.resize(matrix.levels().size());
  for (std::size_t l = 1; l < buffers_.size(); ++l) {
    const PaddedField& shape = matrix.levels()[l].transfer;
    for (PaddedField* field : {&buffers_[l].b, &buffers_[l].z}) field->reshape(shape.rows(), shape.columns());
  }
  const auto columns = static_cast<std::size_t>(matrix.levels().front().transfer.columns());
  ring_.resize(4 * columns);
  line_.resize(2 * columns + 8);
}

double VCycle::apply(const BlendOperator& matrix, const PaddedField& r, PaddedField& z) {
  return cycle(matrix, 0, r, z);
}

double VCycle::apply(const BlendOperator& matrix, const Advance& advance, PaddedField& r, PaddedField& z) {
  const BlendOperator::Level& level = matrix.levels().front();
  const auto smooth = [&](int row) {
    advance_row(advance.alpha, advance.p->row(row), advance.q->row(row), level.smoother_factor(),
                level.smoother_row(row), advance.x->row(row), r.row(row), z.row(row), r.columns());
  };
  if (buffers_.size() == 1) {
    for (int row = 0; row < r.rows(); ++row) smooth(row);
    return solve_coarsest(matrix, r, z);
  }
  down(matrix, 0, r, z, smooth);
  cycle(matrix, 1, buffers_[1].b, buffers_[1].z);
  return up(matrix, 0, r, z);
}

double VCycle::cycle(const BlendOperator& matrix, std::size_t l, const PaddedField& b, PaddedField& z) {
  if (l + 1 == buffers_.size()) return solve_coarsest(matrix, b, z);
  const BlendOperator::Level& level = matrix.levels()[l];
  down(matrix, l, b, z, [&](int row) {
    scaled_product_row(level.smoother_factor(), level.smoother_row(row), b.row(row), z.row(row), z.columns());
  });
  cycle(matrix, l + 1, buffers_[l + 1].b, buffers_[l + 1].z);
  return up(matrix, l, b, z);
}

/// What row `row` of S·(b − A·z) completes of the coarse right-hand side; the last four rows are in the ring.
void VCycle::restrict_rows(int row, int rows, int stride, PaddedField& coarse) {
  const auto emit = [&](int j) {
    const float* around[4];
    for (int k = 0; k < 4; ++k)
      around[k] = ring_.data() + static_cast<std::ptrdiff_t>(std::clamp(2 * j - 1 + k, 0, rows - 1) % 4) * stride;
    restrict_row(around, line_.data(), coarse.row(j), coarse.columns());
  };
  if (row >= 2 && row % 2 == 0) emit(row / 2 - 1);
  if (row == rows - 1) emit(rows / 2 - 1);
}

template <class Smooth>
void VCycle::down(const BlendOperator& matrix, std::size_t l, const PaddedField& b, PaddedField& z,
                  const Smooth& smooth) {
  const BlendOperator::Level& level = matrix.levels()[l];
  const int rows = z.rows(), columns = z.columns();
  operator_.start(level, z);
  for (int ahead = 0; ahead < rows + 2; ++ahead) {
    if (ahead < rows) {
      smooth(ahead);
      z.reflect_columns(ahead);
    }
    const int row = ahead - 2;
    if (row < 0) continue;
    operator_.residual(row, b.row(row), line_.data());
    scaled_product_row(1.0F, level.transfer.row(row), line_.data(),
                       ring_.data() + static_cast<std::ptrdiff_t>(row % 4) * columns, columns);
    restrict_rows(row, rows, columns, buffers_[l + 1].b);
  }
}

double VCycle::up(const BlendOperator& matrix, std::size_t l, const PaddedField& b, PaddedField& z) {
  const BlendOperator::Level& level = matrix.levels()[l];
  const PaddedField& coarse = buffers_[l + 1].z;
  const int rows = z.rows(), columns = z.columns();
  const auto corrected = [&](int row) { return ring_.data() + static_cast<std::ptrdiff_t>(row % 3) * columns; };
  double product = 0.0;
  operator_.start(level, z);
  for (int ahead = 0; ahead < rows + 4; ++ahead) {
    if (ahead < rows) {
      const int near = ahead / 2, away = ahead % 2 == 0 ? near - 1 : near + 1;
      prolong_row(coarse.row(near), coarse.reflected(away), level.transfer.row(ahead), line_.data(), z.row(ahead),
                  coarse.columns());
      z.reflect_columns(ahead);
    }
    const int row = ahead - 2, done = ahead - 4;
    if (row >= 0 && row < rows) operator_.residual(row, b.row(row), line_.data());
    if (done >= 0) {
      std::copy_n(corrected(done), columns, z.row(done));
      z.reflect_columns(done);
    }
    if (row >= 0 && row < rows)
      product += correct_row(level.smoother_factor(), level.smoother_row(row), line_.data(), z.row(row), b.row(row),
                             corrected(row), columns);
  }
  return product;
}

double VCycle::solve_coarsest(const BlendOperator& matrix, const PaddedField& b, PaddedField& z) {
  direct_.clear();
  for (int r = 0; r < b.rows(); ++r) direct_.insert(direct_.end(), b.row(r), b.row(r) + b.columns());
  matrix.coarsest().solve(direct_, direct_work_);
  auto from = direct_.cbegin();
  double product = 0.0;
  for (int r = 0; r < z.rows(); ++r) {
    for (int c = 0; c < z.columns(); ++c) z.row(r)[c] = static_cast<float>(*from++);
    z.reflect_columns(r);
    product += dot_row(b.row(r), z.row(r), z.columns());
  }
  return product;
}

}  // namespace scree::fractal
