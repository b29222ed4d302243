#pragma once
// The way of the simulated robot over its terrain.

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "drivers/frame/pose_track.hpp"
#include "drivers/terrain.hpp"

namespace scree::drivers {

/// A place on the plane at a time; heading is counter-clockwise from the map's x axis.
struct PlanarPose {
  Duration t{0};
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};

enum class BodyPlacement : std::uint8_t {
  footprint,        ///< z, roll and pitch from the plane fitted to the terrain under the footprint
  gravity_aligned,  ///< z from that plane, the body's z axis upright
};

struct TrajectoryConfig {
  BodyPlacement placement = BodyPlacement::footprint;
  double footprint_length_m = 0.6;  ///< along the body's x
  double footprint_width_m = 0.5;
  Duration pose_period = std::chrono::milliseconds(10);
  /// The robot stands still after its last pose for this long, so that a frame begun in time can be finished.
  Duration hold{0};
};

/// The poses of a drive: `line:X0,Y0,HEADING_DEG,LENGTH_M,SPEED_MPS`,
/// `arc:X0,Y0,HEADING_DEG,RADIUS_M,ANGLE_DEG,SPEED_MPS` (positive angles turn left), or a `FILE.csv` with a header
/// line: `t_s,x_m,y_m,heading_deg` is put onto the terrain like the others, `t_s,x_m,y_m,z_m,qx,qy,qz,qw` (a
/// recording's poses.csv) is taken as it is. Body frame: origin on the ground in the middle of the footprint, REP-103
/// axes. Errors: usage (the grammar), no_input, bad_data (the file's line), usage again where the way leaves the
/// terrain.
struct Trajectory {
  PoseTrack track;
  Duration drive{0};  ///< from the first pose to the last, without the hold
};
Result<Trajectory> make_trajectory(std::string_view specification, const Terrain& terrain,
                                   const TrajectoryConfig& config);

/// The body's pose on the terrain at one place. Errors: usage (the footprint is not on the terrain).
Result<Pose> place_on_terrain(const PlanarPose& place, const Terrain& terrain, const TrajectoryConfig& config);

}  // namespace scree::drivers
