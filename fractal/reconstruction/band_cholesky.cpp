#include "fractal/reconstruction/band_cholesky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace scree::fractal {

std::size_t BandCholesky::unknown(int row, int column) const {
  return rows_ < columns_
             ? static_cast<std::size_t>(column) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row)
             : static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

void BandCholesky::add_prior(BlendWeights weights) {
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      // One row of the Laplacian: w1·L adds it where it stands, w2·L² = w2·Σ L_k'·L_k adds its outer product.
      std::array<std::pair<std::size_t, double>, 5> row;
      std::size_t n = 1;
      for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
        if (r + dr >= 0 && r + dr < rows_ && c + dc >= 0 && c + dc < columns_)
          row[n++] = {unknown(r + dr, c + dc), -1.0};
      const std::size_t here = unknown(r, c);
      row[0] = {here, static_cast<double>(n - 1)};
      for (std::size_t a = 0; a < n; ++a) {
        if (row[a].first <= here) entry(here, row[a].first) += static_cast<double>(weights.w1) * row[a].second;
        for (std::size_t b = 0; b < n; ++b)
          if (row[b].first <= row[a].first)
            entry(row[a].first, row[b].first) += static_cast<double>(weights.w2) * row[a].second * row[b].second;
      }
    }
}

void BandCholesky::factor(int rows, int columns, BlendWeights weights, const std::vector<float>& data_precision) {
  rows_ = rows;
  columns_ = columns;
  const auto cells = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  width_ = std::min(cells - 1, 2 * static_cast<std::size_t>(std::min(rows, columns)));
  band_.assign(cells * (width_ + 1), 0.0);
  add_prior(weights);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      entry(unknown(r, c), unknown(r, c)) +=
          static_cast<double>(data_precision[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
                                             static_cast<std::size_t>(c)]);
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t first = i > width_ ? i - width_ : 0;
    for (std::size_t j = first; j <= i; ++j) {
      double sum = entry(i, j);
      for (std::size_t k = std::max(first, j > width_ ? j - width_ : 0); k < j; ++k) sum -= entry(i, k) * entry(j, k);
      entry(i, j) = i == j ? std::sqrt(std::max(sum, 1e-30)) : sum / entry(j, j);
    }
  }
}

void BandCholesky::solve(std::vector<double>& x, std::vector<double>& work) const {
  const std::size_t cells = x.size();
  work.resize(cells);
  const auto at = [&](std::size_t i, std::size_t j) { return band_[i * (width_ + 1) + (i - j)]; };
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      work[unknown(r, c)] =
          x[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)];
  for (std::size_t i = 0; i < cells; ++i) {
    double sum = work[i];
    for (std::size_t j = i > width_ ? i - width_ : 0; j < i; ++j) sum -= at(i, j) * work[j];
    work[i] = sum / at(i, i);
  }
  for (std::size_t i = cells; i-- > 0;) {
    const double value = work[i] / at(i, i);
    work[i] = value;
    for (std::size_t j = i > width_ ? i - width_ : 0; j < i; ++j) work[j] -= at(i, j) * value;
  }
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      x[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] =
          work[unknown(r, c)];
}

}  // namespace scree::fractal
