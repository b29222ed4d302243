#include "drivers/trajectory.hpp"

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

#include "drivers/table.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

constexpr int kFootprintSamples = 5;  // a side

/// z = height + slope_along · along + slope_across · across over the footprint, least squares.
struct FootprintPlane {
  double height_m = 0.0, slope_along = 0.0, slope_across = 0.0;
  int samples = 0;
};

FootprintPlane fit_plane(const PlanarPose& place, const Terrain& terrain, const TrajectoryConfig& config) {
  const double c = std::cos(place.heading_rad), s = std::sin(place.heading_rad);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  FootprintPlane plane;
  for (int i = 0; i < kFootprintSamples; ++i)
    for (int j = 0; j < kFootprintSamples; ++j) {
      const double along = config.footprint_length_m * (i / (kFootprintSamples - 1.0) - 0.5);
      const double across = config.footprint_width_m * (j / (kFootprintSamples - 1.0) - 0.5);
      const double z = terrain.height_m(place.x_m + c * along - s * across, place.y_m + s * along + c * across);
      if (std::isnan(z)) continue;
      const Eigen::Vector3d row(1.0, along, across);
      normal += row * row.transpose();
      right += row * z;
      ++plane.samples;
    }
  if (2 * plane.samples < kFootprintSamples * kFootprintSamples) return plane;
  const Eigen::Vector3d solution = normal.inverse() * right;  // more than half of a 5 × 5 lattice spans the plane
  plane.height_m = solution[0];
  plane.slope_along = solution[1];
  plane.slope_across = solution[2];
  return plane;
}

/// x along the heading on the plane, z the plane's normal.
Eigen::Quaterniond attitude(const PlanarPose& place, const FootprintPlane& plane, BodyPlacement placement) {
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(place.heading_rad, Eigen::Vector3d::UnitZ()));
  if (placement == BodyPlacement::gravity_aligned) return yaw;
  const Eigen::Vector3d forward = Eigen::Vector3d(1.0, 0.0, plane.slope_along).normalized();
  const Eigen::Vector3d up = Eigen::Vector3d(-plane.slope_along, -plane.slope_across, 1.0).normalized();
  Eigen::Matrix3d axes;
  axes << forward, up.cross(forward), up;
  return (yaw * Eigen::Quaterniond(axes)).normalized();
}

Result<std::vector<StampedPose>> read_poses(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (auto status = io::read_bytes(file, kTableMaxBytes, bytes); !status) return status.error();
  return parse_poses_table(io::as_text(bytes), file.string());
}

}  // namespace

Result<Pose> place_on_terrain(const PlanarPose& place, const Terrain& terrain, const TrajectoryConfig& config) {
  const FootprintPlane plane = fit_plane(place, terrain, config);
  if (2 * plane.samples < kFootprintSamples * kFootprintSamples)
    return Error{
        ErrorKind::usage,
        fmt::format("trajectory: expected ground under the robot all the way, found none at x {:.6g}, y {:.6g} "
                    "(t {} s): the terrain has {} and its holes",
                    place.x_m, place.y_m, format_seconds(place.time.time_since_epoch()), terrain.extent())};
  return Pose{{place.x_m, place.y_m, plane.height_m}, attitude(place, plane, config.placement)};
}

Result<Trajectory> make_trajectory(std::string_view specification, const Terrain& terrain,
                                   const TrajectoryConfig& config) {
  const auto way = planar_way(specification, config.pose_period);
  if (!way) return way.error();
  std::vector<StampedPose> poses;
  if (way->empty()) {
    auto read = read_poses(std::filesystem::path(specification));
    if (!read) return read.error();
    poses = *std::move(read);
  }
  poses.reserve(way->size() + 1);
  for (const PlanarPose& place : *way) {
    const auto pose = place_on_terrain(place, terrain, config);
    if (!pose) return pose.error();
    poses.push_back({place.time, *pose});
  }
  Trajectory trajectory;
  trajectory.drive = poses.back().time - poses.front().time;
  if (config.hold > Duration{0}) poses.push_back({poses.back().time + config.hold, poses.back().T_map_body});
  auto track = PoseTrack::make(std::move(poses));
  if (!track) return track.error();
  for (const StampedPose& pose : track->poses())
    if (const auto gap = track->gap_at(pose.time + Duration(1)))  // a recording of it could not be replayed
      return Error{ErrorKind::bad_data,
                   fmt::format("trajectory: expected different poses at most {} s apart, found {} and {} s",
                               format_seconds(PoseTrack::kMaxGap), format_seconds(gap->before.time_since_epoch()),
                               format_seconds(gap->after.time_since_epoch()))};
  trajectory.track = *std::move(track);
  return trajectory;
}

}  // namespace scree::drivers
