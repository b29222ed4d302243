#include "fractal/reconstruction/conditioning.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/reconstruction/varying_prior.hpp"

namespace scree::fractal {
namespace {

constexpr double kMaxPrecision = 1e6;  // in units of the local change over a cell

}  // namespace

/// Returns the number of measured cells.
double Conditioning::set_precision(const Grid<float>& height_m, const Grid<float>& variance_m2, const LawMap& law,
                                   double cell_m) {
  const double unit2 = unit_m_ * unit_m_;
  double measured = 0.0, weight = 0.0, sum = 0.0;
  precision_.reshape(shape_.rows, shape_.columns);
  for (int r = 0; r < shape_.rows; ++r) {
    float* c = precision_.row(r);
    std::fill_n(c, shape_.columns, 0.0F);
    for (int i = 0; r < height_m.rows() && i < height_m.columns(); ++i) {
      if (!std::isfinite(height_m(r, i))) continue;
      double most = kMaxPrecision;
      if (law.varies()) most *= unit2 / std::pow(std::max(law.at(r, i).rms_change_m(cell_m), 1e-9), 2);
      const double value = std::min(most, unit2 / std::max(0.0, static_cast<double>(variance_m2(r, i))));
      c[i] = static_cast<float>(value);
      weight += value;
      sum += value * static_cast<double>(height_m(r, i));
      measured += 1.0;
    }
  }
  level_m_ = weight > 0.0 ? sum / weight : 0.0;
  return measured;
}

bool Conditioning::load(const Grid<float>& height_m, const Grid<float>& variance_m2, const LawMap& law, CellIndex min,
                        double cell_m) {
  shape_ = MultigridShape(height_m.rows(), height_m.columns());
  dimension_ = std::clamp(law.law.dimension, 2.05, 2.95);
  unit_m_ = std::max(law.law.rms_change_m(cell_m), 1e-9);
  const double measured = set_precision(height_m, variance_m2, law, cell_m);
  if (measured < 1.0) return false;
  const double spacing = std::sqrt(static_cast<double>(height_m.size()) / measured);
  if (law.varies()) {
    smoothest_ =
        varying_prior(law, {min, height_m.rows(), height_m.columns()}, {unit_m_, cell_m, spacing}, shape_, prior_);
  } else {
    prior_ = {};
    prior_.uniform = blend_weights(dimension_, blend_wavenumber(dimension_, spacing));
    smoothest_ = dimension_;
  }
  matrix_.set_up(shape_, prior_, precision_);
  return true;
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
  double weight = 0.0, sum = 0.0;
  for (int r = 0; r < shape_.rows; ++r) {
    const float *c = precision_.row(r), *row = u.row(r);
    for (int i = 0; i < shape_.columns; ++i) {
      weight += static_cast<double>(c[i]);
      sum += static_cast<double>(c[i]) * static_cast<double>(row[i]);
    }
  }
  const auto level = static_cast<float>(sum / weight);
  for (int r = 0; r < shape_.rows; ++r) {
    const float* c = precision_.row(r);
    float *row = u.row(r), *out = b.row(r);
    for (int i = 0; i < shape_.columns; ++i) {
      row[i] -= level;
      out[i] = c[i] > 0.0F ? c[i] * row[i] + std::sqrt(c[i]) * out[i] : 0.0F;
    }
  }
}

}  // namespace scree::fractal
