#pragma once
// One frame onto the map, the map after the pose.

#include <cstdint>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "core/time.hpp"
#include "drivers/frame/point_frame.hpp"
#include "mapping/registration.hpp"

namespace scree::mapping {

/// A frame that contradicts is not fused; the second in a row begins a new map.
inline constexpr int kFramesToContradict = 2;

/// Every frame is laid onto the map (its plane is taken off, all but the part that views of the same ground differ by:
/// 2 mm, 0.6 mrad), so that neighbours agree whatever its pose drifted. Where the disagreement is significant the map
/// follows the pose: in height at once, in tilt with a time constant of 5 s, because height drifts without bound while
/// attitude errs about gravity. A disagreement below three times what views differ by moves no map: ground that is out
/// of sight does not sink. A jump in height or tilt moves the map likewise and is counted; a jump that no plane
/// explains refuses the frame.
class Alignment {
 public:
  /// The frame where it lies on the map as far as the frames before tell. Valid until the next call.
  const PointFrame& place(const PointFrame& points);
  /// True when the returns of the placed frame lie beside the map by a significant step: place() and gather again.
  bool fit(const PointFrame& points, double cell_m, const RollingGrid<MapCell>& map, const FrameReturns& frame);
  /// `frame` is what was last fitted, in the map's window. Changes both.
  AlignmentReport align(const PointFrame& points, double cell_m, Executor& executor, RollingGrid<MapCell>& map,
                        FrameReturns& frame);

  /// At the end of a frame: moves the map by whole cells after the pose.
  void carry(double cell_m, RollingGrid<MapCell>& map);

 private:
  void follow(const FrameFit& fit, double cell_m, Executor& executor, RollingGrid<MapCell>& map, HeightPlane& left);

  Registration registration_;
  FrameFit fit_;
  PlanarShift shift_;  ///< of poses beside the map
  PointFrame placed_;
  bool begun_ = false;
  Eigen::Vector3d body_m_ = Eigen::Vector3d::Zero();
  Time time_;
  double elapsed_s_ = 0.0;  ///< since the frame before
  int contradictions_ = 0;
};

}  // namespace scree::mapping
