#pragma once
// One surface through data that change from fit to fit.

#include "fractal/reconstruction/blend_solver.hpp"

namespace scree::fractal {

/// Buffers and the last solution of A·x = c·d, for methods that fit, weigh the data or the prior anew, and fit again.
/// Heights in one unit of the caller's choice, the prior's weights and the precisions in its inverse square.
class BlendFit {
 public:
  /// The grids of the solver may be larger than the map (MultigridShape); the rest holds no data.
  BlendFit(int rows, int columns) : shape_(rows, columns) {
    for (PaddedField* field : {&precision_, &right_side_, &x_}) field->resize(shape_.rows, shape_.columns);
  }
  /// Weights, and edges if any; fields of the shape that `shape()` says. Its change takes effect with the next fit.
  BlendField& prior() { return prior_; }
  const BlendField& prior() const { return prior_; }
  const MultigridShape& shape() const { return shape_; }

  /// precision ≥ 0; 0 = no datum. Several data of one cell: their weighted mean with the sum of precisions.
  void set_datum(int row, int column, float height, float precision) {
    precision_.row(row)[column] = precision;
    right_side_.row(row)[column] = precision * height;
  }
  /// At least one datum. Starts from the last solution.
  SolveReport solve(double tolerance, int max_iterations = 60) {
    matrix_.set_up(shape_, prior_, precision_);
    return again(tolerance, max_iterations);
  }
  /// With the data's heights changed at most, not their precisions nor the prior.
  SolveReport again(double tolerance, int max_iterations = 60) {
    const SolveReport report = solver_.solve(matrix_, right_side_, tolerance, max_iterations, x_);
    iterations_ += report.iterations;
    return report;
  }
  const float* row(int r) const { return x_.row(r); }
  float* row(int r) { return x_.row(r); }
  /// Of a cell with a datum.
  float height(int row, int column) const { return right_side_.row(row)[column] / precision_.row(row)[column]; }
  float precision(int row, int column) const { return precision_.row(row)[column]; }
  int iterations() const { return iterations_; }  ///< of all fits

 private:
  MultigridShape shape_;
  BlendField prior_;
  PaddedField precision_, right_side_, x_;
  BlendOperator matrix_;
  BlendSolver solver_;
  int iterations_ = 0;
};

}  // namespace scree::fractal
