#pragma once
// What became of a frame's pose against the map.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

namespace scree::mapping {

/// A plane that is added to heights: height_m + slope · (place − centre).
struct HeightPlane {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< map frame
  double height_m = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();

  double at(double x_m, double y_m) const {
    return height_m + slope.x() * (x_m - centre_m.x()) + slope.y() * (y_m - centre_m.y());
  }
};

/// Where a frame lies beside the map: displaced by (x, y) at the body, and turned about it, counter-clockwise.
struct PlanarShift {
  double x_m = 0.0, y_m = 0.0, heading_rad = 0.0;
};

/// How a frame and the map agree.
enum class Agreement : std::uint8_t {
  unknown,      ///< too little overlap to tell: the frame is taken as it is
  registered,   ///< by `frame_less_map`
  jumped,       ///< likewise, by more than a pose that drifts could do
  contradicts,  ///< no plane brings most of the overlap together
};

/// What became of a frame's pose.
struct AlignmentReport {
  Agreement agreement = Agreement::unknown;
  bool refused = false;    ///< the frame contradicts the map and is not fused
  bool forgotten = false;  ///< the second in a row: the map was forgotten, the frame begins a new one
  double height_m = 0.0;   ///< frame − map at the body, before anything was moved
  double tilt_rad = 0.0;
  PlanarShift beside;  ///< of the pose beside the map, as far as frames were placed back
  std::size_t overlap = 0;
  HeightPlane off;  ///< what was taken off the frame's heights: its rays stand off by as much
};

}  // namespace scree::mapping
