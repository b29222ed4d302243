#pragma once
// Exact prediction of fBm from noisy heights on a lattice: dense intrinsic kriging.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::fractal {

/// Prediction under the generalised covariance −½·r^(2H) with an unknown constant (what intrinsic kriging of order 0
/// is), data with independent noise. Lengths in cells, heights in units of the rms change over one cell. Source: [CD12]
/// ch. 3, 4.
class IntrinsicKriging {
 public:
  /// `places`: different cells of a rows × columns lattice; `noise`: variance of each datum, ≥ 0. Factors a dense
  /// matrix: n²·8 bytes, n³/3 operations. Errors: internal where rounding makes the matrix indefinite (H near 1 and no
  /// noise).
  static Result<IntrinsicKriging> make(double hurst, int rows, int columns, std::vector<CellIndex> places,
                                       std::span<const double> noise);

  /// What predicts from `data`, one column per set of data: call it once, then rows of it.
  struct Weights {
    Eigen::MatrixXd alpha;     ///< n × sets, columns sum to 0
    Eigen::RowVectorXd level;  ///< constant of each set
  };
  Weights weights_of(const Eigen::MatrixXd& data) const;

  /// Conditional means of row `row` from set `set`: `columns` values. Cost: n·columns.
  void mean_row(const Weights& weights, Eigen::Index set, int row, double* out) const;

  /// Conditional standard deviations of the true heights at `cells`, of the unknown constant too; any number of cells,
  /// in blocks of kBlock. Cost: n² a cell. Working memory: n·kBlock·8 bytes.
  void deviations(std::span<const CellIndex> cells, double* out) const;

  std::size_t size() const { return places_.size(); }
  static constexpr int kBlock = 32;

 private:
  IntrinsicKriging(double hurst, int rows, int columns, std::vector<CellIndex> places);
  double half_variogram(int dx, int dy) const { return half_variogram_(std::abs(dy), dx + columns_ - 1); }
  double about_centre(CellIndex cell) const;

  int columns_;
  std::vector<CellIndex> places_;
  double hurst_, centre_x_, centre_y_, shift_;
  Grid<double> half_variogram_;  // ½·r^(2H) at (|dy|, dx + columns − 1)
  std::vector<double> potential_;
  Eigen::MatrixXd factor_;         // lower triangle: Cholesky factor of the shifted covariance
  Eigen::VectorXd whitened_ones_;  // L⁻¹·1
};

}  // namespace scree::fractal
