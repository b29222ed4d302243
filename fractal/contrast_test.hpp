#pragma once
// Are the energies of second differences the same in all directions? A chi-square of four contrasts.

#include <Eigen/Core>

#include "core/executor.hpp"
#include "fractal/directed_increments.hpp"
#include "fractal/directional_hurst.hpp"

namespace scree::fractal {

using DirectedMatrix = Eigen::Matrix<double, kDirectedCount, kDirectedCount>;
using ContrastMatrix = Eigen::Matrix<double, kContrastCount, kContrastCount>;
using ContrastVector = Eigen::Matrix<double, kContrastCount, 1>;

/// Covariance of the contrasts ln(q_2i/q_2i+1), from that of the logarithms of the directed mean squares.
ContrastMatrix contrast_covariance(const DirectedMatrix& log_covariance);

struct ContrastTest {
  ContrastVector contrast;          ///< axes and diagonals at step 1, at step 2
  double chi_square = 0.0;          ///< 4 degrees of freedom under `law`
  Eigen::Vector2d signal_contrast;  ///< axes, diagonals: best mean of both steps, without the noise
};

/// cov(ln q_a, ln q_b) = 2/(n_a n_b) Σ_o n_ab(o)·cov(a, b + o)²/(V_a V_b), n_ab(o) counted on the grid itself, so holes
/// and borders are those of the data; increments by the generalised covariance −γ̄/2 of `law` [CD12] ch. 4.
/// Cost: 36 pair_counts.
ContrastTest test_contrasts(const DirectedEnergies& energies, const IsotropicLaw& law, Executor& executor);

}  // namespace scree::fractal
