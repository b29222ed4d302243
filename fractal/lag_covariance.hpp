#pragma once
// Means and covariances of the logarithms of a structure function under a law of the ground.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "fractal/ground_law.hpp"
#include "fractal/lag_statistics.hpp"
#include "fractal/plane_loss.hpp"

namespace scree::fractal {

/// The structure function at lag l is a quadratic form of the heights with symbol F_l(ω) = 2·mean(1 − b·cos ω·u) over
/// the offsets u of its annulus (b = e^(−blur²ω²): displaced places), so for stationary increments with spectrum f
///   cov(S_l, S_m) = 2/(2π)²/area·∫ f²·F_l·F_m dω,
/// a Gram matrix, hence positive: over the first zone of a lattice with f folded into it, or over the plane for
/// scattered points, where pairs that share a point or both add what the plane's integral leaves out. Waves longer than
/// the survey are damped by what its least-squares plane leaves of them. Unlike a jackknife over tiles it knows about
/// waves longer than a tile, and unlike a sum over pairs of pairs it costs about a millisecond.
class LagModel {
 public:
  explicit LagModel(const LagStatistics& statistics);

  Eigen::Index lags() const { return static_cast<Eigen::Index>(statistics_.lags.size()); }
  /// E S_l: with what the plane takes, white noise and all.
  Eigen::VectorXd expected(const GroundLaw& law) const;
  /// Relative: of S_l / E S_l, to first order that of ln S_l. Cost: ~1000 spectra, lags² · 1000 multiplications.
  Eigen::MatrixXd covariance(const GroundLaw& law) const;

 private:
  struct Nodes {
    std::vector<double> omega_x, omega_y, weight;
    void add(double x, double y, double w);
  };
  void place_lattice_nodes();
  void place_plane_nodes();
  struct Offset {
    std::size_t x, y;  ///< cells, 0 or more
    double images;     ///< how many offsets mirrored to all quadrants
  };
  struct Offsets {
    std::vector<Offset> quadrant;
    double count = 0.0;
  };
  static Offsets offsets_of(const Lag& lag, double cell);
  static double lattice_symbol(const Offsets& offsets, std::span<const double> cos_x, std::span<const double> cos_y);
  double folded_spectrum(const GroundLaw& law, double omega_x, double omega_y) const;
  Eigen::VectorXd variogram(const GroundLaw& law) const;
  double slope_excess(const Eigen::VectorXd& variogram) const;
  void add_shared_points(const GroundLaw& law, double white, Eigen::MatrixXd& covariance) const;

  const LagStatistics& statistics_;
  PlaneLoss plane_;
  Nodes nodes_;
  Eigen::MatrixXd symbols_;  ///< nodes × lags: √weight·F, damped
};

}  // namespace scree::fractal
