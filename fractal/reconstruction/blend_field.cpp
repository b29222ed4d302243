#include "fractal/reconstruction/blend_field.hpp"

#include <algorithm>

namespace scree::fractal {
namespace {

void reflect_all(PaddedField& field) {
  for (int r = 0; r < field.rows(); ++r) field.reflect_columns(r);
}

void mean_of_four(const PaddedField& fine, float factor, PaddedField& coarse) {
  coarse.reshape(fine.rows() / 2, fine.columns() / 2);
  for (int r = 0; r < coarse.rows(); ++r) {
    const float *upper = fine.row(2 * r), *lower = fine.row(2 * r + 1);
    float* out = coarse.row(r);
    for (int c = 0; c < coarse.columns(); ++c)
      out[c] = 0.25F * factor * ((upper[2 * c] + upper[2 * c + 1]) + (lower[2 * c] + lower[2 * c + 1]));
  }
  reflect_all(coarse);
}

/// Half of the edge inside either cell and the whole edge between them, one after the other; 1 of ones.
float in_series(float inside, float between, float beyond) {
  constexpr float kLeast = 1e-6F;
  return 2.0F / (0.5F / std::max(inside, kLeast) + 1.0F / std::max(between, kLeast) + 0.5F / std::max(beyond, kLeast));
}

void coarsen_edges(const BlendField& fine, BlendField& coarse) {
  const int rows = fine.right.rows() / 2, columns = fine.right.columns() / 2;
  coarse.right.reshape(rows, columns);
  coarse.down.reshape(rows, columns);
  for (int r = 0; r < rows; ++r) {
    float *right = coarse.right.row(r), *down = coarse.down.row(r);
    const float *upper = fine.right.row(2 * r), *lower = fine.right.row(2 * r + 1);
    const float *inside = fine.down.row(2 * r), *between = fine.down.row(2 * r + 1);
    const float* beyond = fine.down.row(std::min(2 * r + 2, fine.down.rows() - 1));
    for (int c = 0; c < columns; ++c) {
      const int i = 2 * c, next = std::min(i + 2, fine.right.columns() - 1);
      right[c] =
          0.5F * (in_series(upper[i], upper[i + 1], upper[next]) + in_series(lower[i], lower[i + 1], lower[next]));
      down[c] = 0.5F *
                (in_series(inside[i], between[i], beyond[i]) + in_series(inside[i + 1], between[i + 1], beyond[i + 1]));
    }
  }
  reflect_all(coarse.right);
  reflect_all(coarse.down);
}

}  // namespace

void coarsen(const BlendField& fine, BlendField& coarse) {
  coarse.uniform = {fine.uniform.w1, fine.uniform.w2 / 4.0F};
  if (fine.varies()) {
    mean_of_four(fine.w1, 1.0F, coarse.w1);
    mean_of_four(fine.w2, 0.25F, coarse.w2);
  } else {
    coarse.w1 = {}, coarse.w2 = {};
  }
  if (fine.broken()) {
    coarsen_edges(fine, coarse);
  } else {
    coarse.right = {}, coarse.down = {};
  }
}

}  // namespace scree::fractal
