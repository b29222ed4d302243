#pragma once
// The blend prior as a dense matrix, built edge by edge.

#include <Eigen/Core>

#include "fractal/reconstruction/blend_prior.hpp"

namespace scree::fractal {

/// Graph Laplacian of the 4-neighbour grid, row-major cells: degree on the diagonal, −1 for neighbours.
inline Eigen::MatrixXd grid_laplacian(int rows, int columns) {
  Eigen::MatrixXd l = Eigen::MatrixXd::Zero(rows * columns, rows * columns);
  const auto edge = [&l](int a, int b) {
    l(a, a) += 1.0, l(b, b) += 1.0;
    l(a, b) -= 1.0, l(b, a) -= 1.0;
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (c + 1 < columns) edge(r * columns + c, r * columns + c + 1);
      if (r + 1 < rows) edge(r * columns + c, (r + 1) * columns + c);
    }
  return l;
}

inline Eigen::MatrixXd dense_blend(int rows, int columns, BlendWeights weights) {
  const Eigen::MatrixXd l = grid_laplacian(rows, columns);
  return static_cast<double>(weights.w1) * l + static_cast<double>(weights.w2) * l * l;
}

}  // namespace scree::fractal
