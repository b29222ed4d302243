#include "fractal/reconstruction/conditioning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"
#include "fractal/reconstruction/stencil_rows.hpp"

namespace scree::fractal {
namespace {

constexpr float kMaxPrecision = 1e6F;  // in units of the local change over a cell
constexpr float kLocal = 10.0F;        // 1/w2 of a cell in those units: 2 … 16 over D, and no more is needed

/// c = min(most, unit²/variance) and √c where a height is known, else 0; c·(height − base) into `moment`.
SCREE_CLONES void precision_row(const float* __restrict height, const float* __restrict variance, float unit2,
                                float base, const float* __restrict most, float* __restrict c, float* __restrict root,
                                float* __restrict moment, int n) {
  for (int i = 0; i < n; ++i) {
    const float above = height[i] - base, zero = above - above;  // zero is not 0 where the height is NaN or infinite
    const float value = std::min(most[i], unit2 / std::max(1e-30F, variance[i]));
    c[i] = zero == 0.0F ? value : 0.0F;
    moment[i] = zero == 0.0F ? value * above : 0.0F;
  }
  for (int i = 0; i < n; ++i) {
    float log;  // a square root would call for errno and stay scalar
    fast_log<float, std::int32_t>(c[i] + 1e-30F, log);
    root[i] = fast_exp(0.5F * log);
  }
}

/// u −= level, b = c·u + root·b.
SCREE_CLONES void right_side_row(float level, const float* __restrict c, const float* __restrict root,
                                 float* __restrict u, float* __restrict b, int n) {
  for (int i = 0; i < n; ++i) {
    const float here = u[i] - level;
    u[i] = here;
    b[i] = c[i] * here + root[i] * b[i];
  }
}

SCREE_CLONES int count_known(const float* height, int n) {
  int count = 0;
  for (int i = 0; i < n; ++i) count += height[i] - height[i] == 0.0F ? 1 : 0;
  return count;
}

/// The number of known heights, and one of them.
std::pair<std::size_t, float> known_heights(const Grid<float>& height_m) {
  std::size_t count = 0;
  for (int r = 0; r < height_m.rows(); ++r)
    count += static_cast<std::size_t>(count_known(height_m.row(r).data(), height_m.columns()));
  const auto first = std::find_if(height_m.begin(), height_m.end(), [](float z) { return z - z == 0.0F; });
  return {count, first == height_m.end() ? 0.0F : *first};
}

}  // namespace

void Conditioning::set_precision(const Grid<float>& height_m, const Grid<float>& variance_m2, float base_m) {
  const int columns = height_m.columns();
  for (PaddedField* field : {&precision_, &root_}) field->resize(shape_.rows, shape_.columns);
  const auto n = static_cast<std::size_t>(columns);
  std::vector<float>&most = lines_[0], &moment = lines_[1], &ones = lines_[2];
  most.assign(n, kMaxPrecision);
  moment.assign(n, 0.0F);
  ones.assign(n, 1.0F);
  double weight = 0.0, sum = 0.0;
  for (int r = 0; r < height_m.rows(); ++r) {
    if (prior_.varies())
      for (std::size_t i = 0; i < most.size(); ++i) most[i] = kMaxPrecision * kLocal * prior_.w2.row(r)[i];
    precision_row(height_m.row(r).data(), variance_m2.row(r).data(), static_cast<float>(unit_m_ * unit_m_), base_m,
                  most.data(), precision_.row(r), root_.row(r), moment.data(), columns);
    weight += dot_row(precision_.row(r), ones.data(), columns);
    sum += dot_row(moment.data(), ones.data(), columns);
  }
  weight_ = weight;
  level_m_ = static_cast<double>(base_m) + sum / weight;
}

bool Conditioning::load(const Grid<float>& height_m, const Grid<float>& variance_m2, const LawMap& law, CellIndex min,
                        double cell_m) {
  shape_ = MultigridShape(height_m.rows(), height_m.columns());
  dimension_ = std::clamp(law.law.dimension, 2.05, 2.95);
  unit_m_ = std::max(law.law.rms_change_m(cell_m), 1e-9);
  const auto [measured, base_m] = known_heights(height_m);
  if (measured == 0) return false;
  spacing_ = std::sqrt(static_cast<double>(height_m.size()) / static_cast<double>(measured));
  prior_.right = prior_.down = PaddedField();
  if (law.varies()) {
    smoothest_ = varying_prior_.set(law, {min, height_m.rows(), height_m.columns()}, {unit_m_, cell_m, spacing_},
                                    shape_, prior_);
  } else {
    prior_ = {};
    prior_.uniform = blend_weights(dimension_, blend_wavenumber(dimension_, spacing_));
    smoothest_ = dimension_;
  }
  set_precision(height_m, variance_m2, base_m);
  matrix_.set_up(shape_, prior_, precision_);
  return true;
}

void Conditioning::set_edges(const BlendField& prior) {
  prior_.right = prior.right;
  prior_.down = prior.down;
  matrix_.set_up(shape_, prior_, precision_);
}

void Conditioning::mean_problem(const Grid<float>& height_m, PaddedField& b) const {
  b.reshape(shape_.rows, shape_.columns);
  const auto scale = static_cast<float>(1.0 / unit_m_), offset = static_cast<float>(level_m_);
  for (int r = 0; r < shape_.rows; ++r) {
    const float* c = precision_.row(r);
    float* out = b.row(r);
    std::fill_n(out, shape_.columns, 0.0F);
    for (int i = 0; r < height_m.rows() && i < height_m.columns(); ++i)
      if (c[i] > 0.0F) out[i] = c[i] * (scale * (height_m(r, i) - offset));
  }
}

void Conditioning::residual_problem(PaddedField& u, PaddedField& b) const {
  double sum = 0.0;
  for (int r = 0; r < shape_.rows; ++r) sum += dot_row(precision_.row(r), u.row(r), shape_.columns);
  const auto level = static_cast<float>(sum / weight_);
  for (int r = 0; r < shape_.rows; ++r)
    right_side_row(level, precision_.row(r), root_.row(r), u.row(r), b.row(r), shape_.columns);
}

}  // namespace scree::fractal
