#pragma once
// The way of the simulated robot over its terrain.

#include <chrono>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/frame/pose_track.hpp"
#include "drivers/terrain.hpp"

namespace scree::drivers {

/// A place on the plane at a time; heading is counter-clockwise from the map's x axis.
struct PlanarPose {
  Time time;
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

/// A drive as poses in time. Readers interpolate between them, and so does the simulator: there is no finer truth.
struct Trajectory {
  PoseTrack track;
  Duration drive{0};  ///< from the first pose to the last, without the hold
};

inline constexpr std::string_view kTrajectoryGrammar =
    "FILE.csv | line:X0,Y0,HEADING_DEG,LENGTH_M,SPEED_MPS | arc:X0,Y0,HEADING_DEG,RADIUS_M,ANGLE_DEG,SPEED_MPS for "
    "--trajectory";
inline constexpr std::string_view kPlanarHeader = "t_s,x_m,y_m,heading_deg";

/// Lines and arcs start at time 0 in (X0, Y0); positive angles turn left. A `FILE.csv` has a header line:
/// `t_s,x_m,y_m,heading_deg` is put onto the terrain like the others (straight between its places, the short way round
/// in heading), `t_s,x_m,y_m,z_m,qx,qy,qz,qw` (a recording's poses.csv) is taken as it is.
/// Body frame: origin on the ground in the middle of the footprint, REP-103 axes.
/// Errors: usage (the grammar; a way that leaves the terrain, with the place and the terrain's extent), no_input,
/// bad_data (the file's line). Cost: some 30 height look-ups a pose.
Result<Trajectory> make_trajectory(std::string_view specification, const Terrain& terrain,
                                   const TrajectoryConfig& config);

/// The body's pose on the terrain at one place. Errors: usage (less than half of the footprint is on the terrain).
Result<Pose> place_on_terrain(const PlanarPose& place, const Terrain& terrain, const TrajectoryConfig& config);

/// The places of a specification, before they meet a terrain: lines and arcs at `pose_period`, files at least that
/// dense. Empty for a file of full poses. Errors: usage, no_input, bad_data.
Result<std::vector<PlanarPose>> planar_way(std::string_view specification, Duration pose_period);

}  // namespace scree::drivers
