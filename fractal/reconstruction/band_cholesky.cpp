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

void BandCholesky::add_prior(const BlendField& prior) {
  const auto w1 = [&](int r, int c) {
    return static_cast<double>(prior.varies() ? prior.w1.row(r)[c] : prior.uniform.w1);
  };
  const auto edge = [&](int r, int c, int dr, int dc) {
    if (!prior.broken()) return 1.0;
    const PaddedField& edges = dr != 0 ? prior.down : prior.right;
    return static_cast<double>(edges.row(std::min(r, r + dr))[std::min(c, c + dc)]);
  };
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      // One row of L_e: its edges cost their own difference, its sum is bent once, w2·Σ_k L_k'·L_k.
      std::array<std::pair<std::size_t, double>, 5> row;
      std::size_t n = 1;
      const std::size_t here = unknown(r, c);
      row[0] = {here, 0.0};
      for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (r + dr < 0 || r + dr >= rows_ || c + dc < 0 || c + dc >= columns_) continue;
        const double e = edge(r, c, dr, dc), flux = 0.5 * e * (w1(r, c) + w1(r + dr, c + dc));
        const std::size_t there = unknown(r + dr, c + dc);
        row[0].second += e;
        row[n++] = {there, -e};
        entry(here, here) += flux;
        if (there < here) entry(here, there) -= flux;
      }
      const auto w2 = static_cast<double>(prior.varies() ? prior.w2.row(r)[c] : prior.uniform.w2);
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
          if (row[b].first <= row[a].first) entry(row[a].first, row[b].first) += w2 * row[a].second * row[b].second;
    }
}

void BandCholesky::factor(const BlendField& prior, const PaddedField& data_precision) {
  rows_ = data_precision.rows();
  columns_ = data_precision.columns();
  const auto cells = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  width_ = std::min(cells - 1, 2 * static_cast<std::size_t>(std::min(rows_, columns_)));
  band_.assign(cells * (width_ + 1), 0.0);
  columns_of_.assign(band_.size(), 0.0);
  add_prior(prior);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      entry(unknown(r, c), unknown(r, c)) += static_cast<double>(data_precision.row(r)[c]);
  factor_band();
}

void BandCholesky::factor_band() {
  const std::size_t cells = band_.size() / (width_ + 1);
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t first = i > width_ ? i - width_ : 0;
    for (std::size_t j = first; j <= i; ++j) {
      double sum = entry(i, j);
      for (std::size_t k = std::max(first, j > width_ ? j - width_ : 0); k < j; ++k) sum -= entry(i, k) * entry(j, k);
      entry(i, j) = i == j ? std::sqrt(std::max(sum, 1e-30)) : sum / entry(j, j);
      columns_of_[j * (width_ + 1) + (i - j)] = i == j ? 1.0 / entry(i, i) : entry(i, j);
    }
  }
}

void BandCholesky::solve(std::vector<double>& x, std::vector<double>& work) const {
  const std::size_t cells = x.size();
  work.resize(cells);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      work[unknown(r, c)] =
          x[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)];
  for (std::size_t i = 0; i < cells; ++i) {
    const double* column = columns_of_.data() + i * (width_ + 1);
    const double value = work[i] * column[0];
    work[i] = value;
    const std::size_t below = std::min(width_, cells - 1 - i);
    for (std::size_t k = 1; k <= below; ++k) work[i + k] -= column[k] * value;
  }
  for (std::size_t i = cells; i-- > 0;) {
    const double* row = band_.data() + i * (width_ + 1);
    const double value = work[i] * columns_of_[i * (width_ + 1)];
    work[i] = value;
    const std::size_t before = std::min(width_, i);
    for (std::size_t k = 1; k <= before; ++k) work[i - k] -= row[k] * value;
  }
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      x[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] =
          work[unknown(r, c)];
}

}  // namespace scree::fractal
