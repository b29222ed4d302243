#pragma once
// Surveys of known D, and the exact restricted likelihood to compare with.

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.hpp"
#include "fractal/fbm_points.hpp"
#include "fractal/vecchia.hpp"

namespace scree::fractal {

/// Lengths in mean spacings, heights in rms changes over one.
struct Scattered {
  std::vector<double> x, y, z;
  SurveyPoints survey(double noise = 0.0) const { return {.x_m = x, .y_m = y, .z_m = z, .noise_sigma_m = noise}; }
};

inline Scattered scattered_places(std::size_t count, std::uint64_t seed) {
  Scattered out;
  const double side = std::sqrt(static_cast<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto words = random_words(seed, 1, static_cast<std::int32_t>(i), 0);
    out.x.push_back(side * to_uniform(words[0]));
    out.y.push_back(side * to_uniform(words[1]));
  }
  return out;
}

inline void add_noise_and_tilt(Scattered& survey, double noise, double tilt, std::uint64_t seed) {
  for (std::size_t i = 0; i < survey.z.size(); ++i)
    survey.z[i] += tilt * survey.x[i] + noise * random_normals(seed, 2, static_cast<std::int32_t>(i), 0)[0];
}

inline Scattered rough_survey(std::size_t count, double dimension, std::uint64_t seed, double noise = 0.0) {
  Scattered out = scattered_places(count, seed);
  out.z = FbmPoints::make({dimension, 1.0}, out.x, out.y)->draw(seed);
  add_noise_and_tilt(out, noise, 0.5, seed);
  return out;
}

/// −2 log restricted likelihood, plane and C profiled out, of dense matrices: contrasts orthogonal to 1, x, y.
/// noise_share may be empty (all 1); tau = noise variance over C.
inline double exact_reml(const Eigen::MatrixXd& xyz, double hurst, double tau, const Eigen::VectorXd& noise_share) {
  const Eigen::Index n = xyz.rows();
  Eigen::MatrixXd drift(n, 3);
  drift << Eigen::VectorXd::Ones(n), xyz.col(0), xyz.col(1);
  const Eigen::MatrixXd full = drift.householderQr().householderQ() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd contrasts = full.rightCols(n - 3);
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      k(i, j) =
          i == j ? tau * noise_share[i] : -0.5 * std::pow((xyz.row(i) - xyz.row(j)).head<2>().squaredNorm(), hurst);
  const Eigen::LLT<Eigen::MatrixXd> llt(contrasts.transpose() * k * contrasts);
  const Eigen::VectorXd white = llt.matrixL().solve(contrasts.transpose() * xyz.col(2));
  const double count = static_cast<double>(n - 3);
  return count * std::log(white.squaredNorm() / count) + 2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

}  // namespace scree::fractal
