#include "fractal/reconstruction/break_inflation.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/reconstruction/box_cascade.hpp"
#include "fractal/reconstruction/distance_transform.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kFoldStream = 0x666f6c64;  // "fold"
constexpr int kMaxRadius = 64;
constexpr float kBroken = 0.5F;

int fold_of(int row, int column, int folds) {
  return static_cast<int>(random_words(0, kFoldStream, column, row)[0] % static_cast<std::uint32_t>(folds));
}

/// Adds the squared normalised errors of the fold's data to `errors`.
void predict_fold(const BlendFit& fit, int fold, const Grid<float>& alone, double hurst, const Grid<float>& change,
                  const LineProcessOptions& lines, int folds, BlendFit& held, Grid<float>& errors) {
  const double fewer = std::pow(static_cast<double>(folds) / (folds - 1), hurst);
  held.prior().right = held.prior().down = PaddedField();
  const auto left_out = [&](int r, int c) { return fit.precision(r, c) > 0.0F && fold_of(r, c, folds) == fold; };
  for (int r = 0; r < alone.rows(); ++r) {
    std::copy_n(fit.row(r), fit.shape().columns, held.row(r));
    for (int c = 0; c < alone.columns(); ++c)
      if (fit.precision(r, c) > 0.0F)
        held.set_datum(r, c, fit.height(r, c), left_out(r, c) ? 0.0F : fit.precision(r, c));
  }
  held.solve(0.02);
  break_edges(held, change, lines);
  for (int r = 0; r < alone.rows(); ++r)
    for (int c = 0; c < alone.columns(); ++c) {
      if (!left_out(r, c)) continue;
      const double error = static_cast<double>(fit.height(r, c) - held.row(r)[c]);
      const double variance = fewer * static_cast<double>(alone(r, c)) + 1.0 / static_cast<double>(fit.precision(r, c));
      errors(r, c) = static_cast<float>(error * error / variance);
    }
}

/// 1 beside a broken edge.
Grid<std::uint8_t> beside_breaks(const BlendField& prior, int rows, int columns) {
  Grid<std::uint8_t> beside(rows, columns, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (c + 1 < columns && prior.right.row(r)[c] < kBroken) beside(r, c) = beside(r, c + 1) = 1;
      if (r + 1 < rows && prior.down.row(r)[c] < kBroken) beside(r, c) = beside(r + 1, c) = 1;
    }
  return beside;
}

}  // namespace

Grid<float> break_inflation(const BlendFit& fit, const Grid<float>& alone, double hurst, const Grid<float>& change,
                            const LineProcessOptions& lines, const InflationOptions& options) {
  const int rows = alone.rows(), columns = alone.columns();
  Grid<float> factor(rows, columns, 1.0F), errors(rows, columns, 0.0F);
  int data = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) data += fit.precision(r, c) > 0.0F ? 1 : 0;
  const Grid<std::uint8_t> beside = beside_breaks(fit.prior(), rows, columns);
  if (data < 2 * options.folds || std::find(beside.begin(), beside.end(), 1) == beside.end()) return factor;

  BlendFit held = fit;
  for (int fold = 0; fold < options.folds; ++fold)
    predict_fold(fit, fold, alone, hurst, change, lines, options.folds, held, errors);
  const double spacing = std::sqrt(static_cast<double>(alone.size()) / data);
  const int radius = std::min(BoxCascade::radius_of(options.reach * spacing), kMaxRadius);
  BoxCascade sum, count;
  sum.resize(rows, columns, radius);
  count.resize(rows, columns, radius);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      sum.row(r)[static_cast<std::size_t>(c)] = errors(r, c);
      count.row(r)[static_cast<std::size_t>(c)] = fit.precision(r, c) > 0.0F ? 1.0F : 0.0F;
    }
  sum.smooth();
  count.smooth();
  SerialExecutor serial;
  Grid<std::int32_t> squared;
  DistanceTransform().transform(beside, serial, squared);
  const double reach2 = std::pow(options.edge_reach * spacing, 2);
  const auto prior = static_cast<float>(options.prior_count) * count.own_weight();
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(c);
      if (squared(r, c) <= reach2)
        factor(r, c) = std::max(1.0F, (prior + sum.smoothed(r)[i]) / (prior + count.smoothed(r)[i]));
    }
  return factor;
}

}  // namespace scree::fractal
