#include "fractal/reconstruction/ceiling_sums.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/reconstruction/box_cascade.hpp"

namespace scree::fractal {
namespace {

constexpr int kRadius = 2;  // of the smoothing: three boxes of five cells

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

void CeilingSums::finish(int fields, const CellSamples& samples, Grid<float>& mean_m, Grid<float>& sd_m) const {
  const int rows = delta_.rows(), columns = delta_.columns();
  const auto k = static_cast<float>(fields);
  BoxCascade before, after;
  for (BoxCascade* cascade : {&before, &after}) cascade->resize(rows, columns, kRadius);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const float shift = delta_(r, c) / k, inverse = 1.0F / (sd_m(r, c) * sd_m(r, c));
      const float spread = pushed2_(r, c) / k - 2.0F * shift * pushed_(r, c) / k + shift * shift;
      const float of_mean = fields > 1 ? (delta2_(r, c) / k - shift * shift) / (k - 1.0F) : 0.0F;
      before.row(r)[i] = inverse * square_(r, c) / k;
      after.row(r)[i] = inverse * std::max(spread + of_mean, 0.0F);
      mean_m(r, c) += shift;
    }
  before.smooth();
  after.smooth();
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(c);
      if (std::isfinite(samples.height_m(r, c)) || !(before.smoothed(r)[i] > 0.0F)) continue;
      sd_m(r, c) *= std::sqrt(after.smoothed(r)[i] / before.smoothed(r)[i]);
    }
}

}  // namespace scree::fractal
