// KITTI odometry layout. Poses there are those of the left camera (x right, y down, z forward) in the first camera's
// frame; Tr takes Velodyne points (x forward, y left, z up: our body) to the camera.
// Source: [GLU12] Geiger, Lenz, Urtasun, "Are we ready for autonomous driving?", CVPR 2012, and the odometry devkit.

#include <charconv>
#include <fmt/format.h>

#include "drivers/kitti_tables.hpp"
#include "drivers/recording_source.hpp"

namespace scree::drivers {
namespace {

template <class Parse>
auto read(const std::filesystem::path& file, Parse parse) -> decltype(parse({}, {})) {
  const auto text = read_table_text(file);
  if (!text) return text.error();
  return parse(*text, file.string());
}

/// Camera axes of the first frame → map axes: x forward = z, y left = −x, z up = −y.
Pose T_map_camera0() {
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Eigen::Vector3d::Zero(), Eigen::Quaterniond(rotation)};
}

/// The line of times.txt and poses.txt that belongs to a scan: the i-th where there are as many scans as lines, else
/// the one that the scan's number names (a subset of a sequence, or a scan that is missing).
Result<std::size_t> line_of_scan(const std::filesystem::path& file, std::size_t i, std::size_t scans,
                                 std::size_t lines) {
  if (scans == lines) return i;
  const std::string stem = file.stem().string();
  std::size_t number = 0;
  const auto [end, status] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  if (status != std::errc{} || end != stem.data() + stem.size() || number >= lines)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a scan number below {} (the lines of times.txt and poses.txt), found '{}'",
                             file.string(), lines, stem)};
  return number;
}

}  // namespace

Result<std::unique_ptr<Source>> open_kitti(const std::filesystem::path& directory, const SensorConfig& sensor,
                                           ReplayWindow window) {
  const auto files = list_files(directory / "velodyne", ".bin");
  if (!files) return files.error();
  const auto times = read(directory / "times.txt", parse_kitti_times);
  if (!times) return times.error();
  const auto cameras = read(directory / "poses.txt", parse_kitti_poses);
  if (!cameras) return cameras.error();
  const auto T_camera_velodyne = read(directory / "calib.txt", parse_kitti_calibration);
  if (!T_camera_velodyne) return T_camera_velodyne.error();
  if (times->size() != cameras->size())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected one pose for each of the {} lines of times.txt, found {}",
                             (directory / "poses.txt").string(), times->size(), cameras->size())};
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < cameras->size(); ++i)
    poses.push_back({(*times)[i], T_map_camera0() * (*cameras)[i] * *T_camera_velodyne});
  auto track = PoseTrack::make(std::move(poses));
  if (!track) return Error{track.error().kind, (directory / "poses.txt").string() + ": " + track.error().message};

  std::vector<FrameEntry> frames;
  for (std::size_t i = 0; i < files->size(); ++i) {
    const auto line = line_of_scan((*files)[i], i, files->size(), times->size());
    if (!line) return line.error();
    if (!frames.empty() && (*times)[*line] <= frames.back().time)
      return Error{ErrorKind::bad_data, (*files)[i].string() + ": expected a number above that of the scan before it"};
    frames.push_back({(*files)[i], (*times)[*line], *line});
  }
  SensorConfig cloud = sensor;
  cloud.projection.kind = ProjectionKind::cloud;
  return make_file_source({directory.string(), std::move(frames), std::move(*track), std::move(cloud), {}, {}}, window);
}

}  // namespace scree::drivers
