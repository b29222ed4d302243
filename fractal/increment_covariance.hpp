#pragma once
// What theory says about two increments of a fractional surface, one shifted against the other.

#include <array>
#include <cstddef>
#include <vector>

#include "fractal/increments.hpp"
#include "fractal/support.hpp"

namespace scree::fractal {

/// Offsets between two increments beyond this many cells (maximum norm) are neglected: second differences decorrelate
/// like r^(2H−4), and it is the squares that are summed.
inline constexpr int kCorrelationReach = 12;

/// Generalised covariance −γ̄/2 at lags of up to `reach` cells in each coordinate.
class IncrementKernel {
 public:
  /// For the variance of an increment.
  static constexpr int kVarianceReach = 2 * kIncrementReach;
  /// For the covariance of two increments within kCorrelationReach of each other.
  static constexpr int kCovarianceReach = kCorrelationReach + 2 * kIncrementReach;

  IncrementKernel(Support support, double hurst, int reach = kCovarianceReach);
  double operator()(int dx, int dy) const;

 private:
  std::size_t index(int dx, int dy) const { return static_cast<std::size_t>(dy * side_ + dx); }
  int side_;
  std::vector<double> values_;
};

/// Per unit of C, and per unit of noise variance of a cell.
struct IncrementCovariance {
  double signal = 0.0, noise = 0.0;
};

/// Two increments; their covariance at any offset. Source: [CD12] chapter 4.
class IncrementPair {
 public:
  IncrementPair(const Increment& p, const Increment& q);
  /// Of p and of q shifted by (ox, oy), both within kCorrelationReach.
  IncrementCovariance covariance(const IncrementKernel& kernel, int ox, int oy) const;
  /// Number of cells that p and q shifted by (ox, oy) have in common.
  int shared_cells(int ox, int oy) const;

 private:
  struct Term {
    int dx, dy;  ///< p_k − q_l
    int weight;  ///< Σ λ_k λ_l
    int pairs;   ///< number of (k, l) at this separation
  };
  std::vector<Term> terms_;
};

}  // namespace scree::fractal
