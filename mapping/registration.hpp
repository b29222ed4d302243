#pragma once
// How a frame lies on the map: the height and tilt that its pose has wrong against the frames before.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "mapping/alignment_report.hpp"
#include "mapping/frame_returns.hpp"
#include "mapping/map_cell.hpp"

namespace scree::mapping {

struct FrameFit {
  Agreement agreement = Agreement::unknown;
  HeightPlane frame_less_map;                            ///< centred at the body; zero unless registered or jumped
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of height, slope x, slope y
  PlanarShift frame_beside_map;                          ///< zero unless registered or jumped
  double shift_chi2 = 0.0;  ///< of that shift against its own covariance, three degrees of freedom
  std::size_t overlap = 0;  ///< cells that both know
  double spread_m = 0.0;    ///< robust standard deviation of the innovations about the plane
};

/// Robust least squares (Cauchy weights, from the median on) of frame − map over the cells that both know: a plane, and
/// minus the map's gradient times a planar shift, as in the point-to-plane distance of ICP. Each cell has
/// the variance of its innovation, and a weak prior (height 5 cm + 3 % of the way since the last frame, tilt 0.02 rad,
/// place 2 cm + 3 %, heading 0.02 rad) stands for what the overlap does not determine. Neighbouring innovations err
/// together, so at most 400 count as independent. Serial and in the order of the cells; at most 4096 of them (evenly
/// taken). Cost: some 0.5 ms. `moved_m`: the body's way since the last frame.
class Registration {
 public:
  FrameFit fit(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m, const Eigen::Vector2d& body_m,
               double moved_m);

 private:
  using Row = Eigen::Matrix<double, 6, 1>;
  struct Innovation {
    Row row;  ///< derivatives by height, slopes, shift and heading
    double z_m, variance_m2;
  };
  void collect(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m, const Eigen::Vector2d& body_m);
  double spread_about(const Row& solution);

  std::vector<Innovation> innovations_;
  std::vector<double> magnitudes_;
  std::size_t overlap_ = 0;
};

/// Adds the plane to every height of the map: measured ones, ceilings and lips; `variance_m2` to the shared variance of
/// the measured ones. Row-parallel.
void add_plane(const HeightPlane& plane, float variance_m2, double cell_m, Executor& executor,
               RollingGrid<MapCell>& map);

/// Takes the plane from the frame's heights; its own uncertainty (`covariance` as in FrameFit) adds to what the frame
/// shares.
void subtract_plane(const HeightPlane& plane, const Eigen::Matrix3d& covariance, const LatticeWindow& window,
                    double cell_m, FrameReturns& frame);

}  // namespace scree::mapping
