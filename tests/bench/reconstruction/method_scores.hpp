#pragma once
// Methods on cells, judged on the same cells of the same surfaces.

#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "fractal/reconstruction/intrinsic_kriging.hpp"
#include "tests/bench/reconstruction/report.hpp"
#include "tests/reconstruction/method_scene.hpp"

namespace scree::bench {

inline constexpr int kMethodSide = 256;
inline constexpr int kMethodMargin = 16;  ///< cells at the border are not judged: triangulations have none there

/// CPU time of this thread.
inline double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

inline Grid<float> middle(const Grid<float>& z) {
  const int side = z.rows() - 2 * kMethodMargin;
  Grid<float> out(side, side);
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) out(r, c) = z(r + kMethodMargin, c + kMethodMargin);
  return out;
}

struct MethodResult {
  fractal::SurfaceEstimate estimate;  ///< sd_m may be NaN in any cell
  Grid<float> draw_m;
  double ms = 0.0;        ///< CPU, all of it
  double surfaces = 1.0;  ///< means and draws made in this time
};

struct Method {
  std::string name;
  double widening = 1.0;  ///< of the 90 % interval, where the sd is estimated from a few draws
  std::function<MethodResult(const fractal::SparseScene&, std::uint64_t seed)> run;
};

/// Of one method at one D. Heights in units of the change over one cell, held-out cells only.
struct MethodScore {
  Errors roughness;  ///< D^ of a draw − D^ of the truth
  Errors slope;      ///< of rms increments over lags 1–2, draw − truth
  double square = 0.0, draw_square = 0.0, absolute = 0.0, cells = 0.0;
  fractal::PredictionScore score;  ///< where there is an sd
  double ms = 0.0;

  double rmse() const { return std::sqrt(square / cells); }
  double draw_rmse() const { return std::sqrt(draw_square / cells); }
  /// Of a method without an sd: the mean absolute error, which is what its certainty scores.
  double crps() const { return score.cells > 0.0 ? score.crps() : absolute / cells; }

  /// `only`: of the sd's scores, cells where it is not NaN.
  void add(const fractal::SparseScene& scene, const MethodResult& result, double widening,
           const Grid<float>* only = nullptr) {
    const double unit = scene.law.rms_change_m(fractal::kSceneCellM);
    const Grid<float> truth = middle(scene.truth), draw = middle(result.draw_m);
    roughness.add(fractal::axis_dimension(draw) - fractal::axis_dimension(truth));
    slope.add(fractal::increment_slope(draw, 1, 2) - fractal::increment_slope(truth, 1, 2));
    ms += result.ms / result.surfaces;
    for (int r = kMethodMargin; r < scene.truth.rows() - kMethodMargin; ++r)
      for (int c = kMethodMargin; c < scene.truth.columns() - kMethodMargin; ++c) {
        if (!std::isnan(scene.height(r, c))) continue;
        const double error = static_cast<double>(scene.truth(r, c) - result.estimate.mean_m(r, c)) / unit;
        const double sd = static_cast<double>(result.estimate.sd_m(r, c)) / unit;
        square += error * error, absolute += std::abs(error), cells += 1.0;
        draw_square += std::pow(static_cast<double>(scene.truth(r, c) - result.draw_m(r, c)) / unit, 2);
        if (!std::isnan(sd) && (only == nullptr || !std::isnan((*only)(r, c)))) score.add(error, widening * sd);
      }
  }
  MethodScore& operator+=(const MethodScore& other) {
    for (const auto& [to, from] : {std::pair(&roughness, &other.roughness), std::pair(&slope, &other.slope)}) {
      to->sum += from->sum, to->sum2 += from->sum2, to->count += from->count;
      if (std::abs(from->worst) > std::abs(to->worst)) to->worst = from->worst;
    }
    square += other.square, draw_square += other.draw_square, absolute += other.absolute, cells += other.cells;
    score += other.score, ms += other.ms;
    return *this;
  }
};

/// Student's quantile of 8 degrees of freedom over the normal one: intervals from 8 draws about a known mean.
inline constexpr double kEightDraws = 1.8595 / fractal::kNormal95;

/// Exact kriging: mean everywhere, one draw, the sd in a random 2 % of the cells (n² operations each). Time: without
/// the sd.
MethodResult run_kriging(const fractal::SparseScene& scene, std::uint64_t seed);
/// The conditional method with its own sd.
MethodResult run_conditional(const fractal::SparseScene& scene, std::uint64_t seed);

}  // namespace scree::bench
