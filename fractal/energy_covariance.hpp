#pragma once
// Covariance of the mean energies of the increment classes over a window.

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "fractal/increment_covariance.hpp"

namespace scree::fractal {

using ClassMatrix = Eigen::Matrix<double, kClassCount, kClassCount>;
using ClassVector = Eigen::Matrix<double, kClassCount, 1>;

/// Σ over pairs of increments of two classes and over all offsets of the squared covariance, as signal², signal·noise
/// and noise² so that (signal + ν·noise)² follows for every nugget ν, and kept apart by the number m of cells that the
/// two increments share: when a cell is known with probability p, independently, both means together weigh such a pair
/// with p^−m.
inline constexpr std::size_t kSharedCounts = 5;  ///< m = 0 … 4
template <class Matrix>
struct SquareSums {
  std::array<Matrix, kSharedCounts> signal2, signal_noise, noise2;

  Matrix at(double nu, double fill) const {
    Matrix sum = Matrix::Zero();
    for (std::size_t m = 0; m < kSharedCounts; ++m)
      sum += std::pow(fill, -static_cast<double>(m)) * (signal2[m] + 2.0 * nu * signal_noise[m] + nu * nu * noise2[m]);
    return sum;
  }
};

using ContrastMatrix = Eigen::Matrix<double, kContrastClassCount, kContrastClassCount>;
/// Of the mean energies of a window of one cell.
struct EnergyCovariance {
  SquareSums<ClassMatrix> energies;      ///< of the classes' means
  SquareSums<ContrastMatrix> contrasts;  ///< of the differences of the means of a class's two directions
};

/// 2/(m_c m_d)·Σ_{a∈c, b∈d} Σ_o cov(a, b + o)², and with the signs of the directions for the contrasts.
/// Source: docs/fractal.md, "D per cell". Cost: some hundred pairs of increments at 625 offsets.
EnergyCovariance energy_covariance(const IncrementKernel& kernel);

}  // namespace scree::fractal
