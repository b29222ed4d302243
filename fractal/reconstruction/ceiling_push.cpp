#include "fractal/reconstruction/ceiling_push.hpp"

#include <algorithm>

namespace scree::fractal {

/// Gives cells that are above their ceiling a datum; returns how many new ones.
int CeilingPush::activate(const PaddedField& precision, const Grid<float>& ceiling, const Grid<float>& change,
                          const PaddedField& sample, const PaddedField& delta) {
  int fresh = 0;
  for (int r = 0; r < ceiling.rows(); ++r)
    for (int c = 0; c < ceiling.columns(); ++c) {
      const float s = sample.row(r)[c], limit = ceiling(r, c), pushed = s + delta.row(r)[c];
      const float height = pushed > limit ? pushed : s;  // above before the push counts too
      if (!(height > limit) || active_(r, c) != 0) continue;
      const float unit = change.empty() ? 1.0F : change(r, c);
      const auto push = static_cast<float>(options_.precision) / (unit * unit);
      const float target =
          limit - static_cast<float>(options_.gain) * (height - limit) - static_cast<float>(options_.margin) * unit;
      active_(r, c) = 1;
      total_.row(r)[c] = precision.row(r)[c] + push;
      right_side_.row(r)[c] = push * (target - s);
      ++fresh;
    }
  return fresh;
}

bool CeilingPush::apply(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision,
                        const Grid<float>& ceiling, const Grid<float>& change, double tolerance, int max_iterations,
                        PaddedField& sample) {
  total_ = precision;
  right_side_.resize(shape.rows, shape.columns);
  delta_.resize(shape.rows, shape.columns);
  active_.assign(ceiling.rows(), ceiling.columns(), 0);
  for (int round = 0; round < options_.rounds; ++round) {
    if (activate(precision, ceiling, change, sample, delta_) == 0) {
      if (round == 0) return false;
      break;
    }
    matrix_.set_up(shape, prior, total_);
    const SolveReport report = solver_.solve(matrix_, right_side_, tolerance, max_iterations, delta_);
    iterations_ += report.iterations;
    converged_ = converged_ && report.converged;
  }
  for (int r = 0; r < shape.rows; ++r)
    for (int c = 0; c < shape.columns; ++c) sample.row(r)[c] += delta_.row(r)[c];
  return true;
}

bool CeilingPush::follow(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision,
                         const Grid<float>& ceiling, const Grid<float>& change, double tolerance, int max_iterations,
                         const PaddedField& sample, PaddedField& delta) {
  total_ = precision;
  right_side_.resize(shape.rows, shape.columns);
  active_.assign(ceiling.rows(), ceiling.columns(), 0);
  iterations_ = 0;
  converged_ = true;
  if (activate(precision, ceiling, change, sample, delta) == 0) {
    delta.resize(shape.rows, shape.columns);
    return false;
  }
  matrix_.set_up(shape, prior, total_);
  const SolveReport report = solver_.solve(matrix_, right_side_, tolerance, max_iterations, delta);
  iterations_ = report.iterations;
  converged_ = report.converged;
  return true;
}

}  // namespace scree::fractal
