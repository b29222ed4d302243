#include "fractal/reconstruction/ceiling_sums.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

constexpr int kRadius = 2;  // of the smoothing: three boxes of five cells

SCREE_CLONES void add_products(const float* __restrict residual, const float* __restrict delta, int n,
                               float* __restrict sum_delta, float* __restrict sum_delta2, float* __restrict square,
                               float* __restrict sum_pushed, float* __restrict sum_pushed2) {
  for (int i = 0; i < n; ++i) {
    const float r = residual[i], d = delta[i], pushed = r + d;
    sum_delta[i] += d;
    sum_delta2[i] += d * d;
    square[i] += r * r;
    sum_pushed[i] += pushed;
    sum_pushed2[i] += pushed * pushed;
  }
}

}  // namespace

void CeilingSums::resize(int rows, int columns) {
  for (Grid<float>* sum : {&delta_, &delta2_, &square_, &pushed_, &pushed2_}) sum->assign(rows, columns, 0.0F);
}

void CeilingSums::add(int row, int column, float residual_m, float delta_m) {
  const float pushed = residual_m + delta_m;
  delta_(row, column) += delta_m;
  delta2_(row, column) += delta_m * delta_m;
  square_(row, column) += residual_m * residual_m;
  pushed_(row, column) += pushed;
  pushed2_(row, column) += pushed * pushed;
}

void CeilingSums::add_row(int row, const float* residual_m, const float* delta_m) {
  add_products(residual_m, delta_m, delta_.columns(), delta_.row(row).data(), delta2_.row(row).data(),
               square_.row(row).data(), pushed_.row(row).data(), pushed2_.row(row).data());
}

void CeilingSums::move_mean(int fields, Grid<float>& mean_m) const {
  for (std::size_t i = 0; i < mean_m.size(); ++i) mean_m[i] += delta_[i] / static_cast<float>(fields);
}

void CeilingSums::finish(int fields, const Grid<float>& height_m, Grid<float>& mean_m, Grid<float>& sd_m) {
  const int rows = delta_.rows(), columns = delta_.columns();
  const auto k = static_cast<float>(fields);
  for (BoxCascade* cascade : {&before_, &after_}) cascade->resize(rows, columns, kRadius);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const float shift = delta_(r, c) / k, inverse = 1.0F / (sd_m(r, c) * sd_m(r, c));
      const float spread = pushed2_(r, c) / k - 2.0F * shift * pushed_(r, c) / k + shift * shift;
      const float of_mean = fields > 1 ? (delta2_(r, c) / k - shift * shift) / (k - 1.0F) : 0.0F;
      before_.row(r)[i] = inverse * square_(r, c) / k;
      after_.row(r)[i] = inverse * std::max(spread + of_mean, 0.0F);
    }
  move_mean(fields, mean_m);
  before_.smooth();
  after_.smooth();
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(c);
      if (std::isfinite(height_m(r, c)) || !(before_.smoothed(r)[i] > 0.0F)) continue;
      sd_m(r, c) *= std::sqrt(after_.smoothed(r)[i] / before_.smoothed(r)[i]);
    }
}

}  // namespace scree::fractal
