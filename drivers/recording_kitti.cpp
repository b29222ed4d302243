// KITTI odometry layout. Poses there are those of the left camera (x right, y down, z forward) in the first camera's
// frame; Tr takes Velodyne points (x forward, y left, z up: our body) to the camera.
// Source: [GLU12] Geiger, Lenz, Urtasun, "Are we ready for autonomous driving?", CVPR 2012, and the odometry devkit.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <functional>

#include "drivers/recording_source.hpp"
#include "drivers/table.hpp"

namespace scree::drivers {
namespace {

/// Calls `take(line_number, line)` for the lines of `file` that are not blank; its errors get "file:line: " before
/// them.
Status for_each_line(const std::filesystem::path& file,
                     const std::function<Status(std::size_t, std::string_view)>& take) {
  const auto text = read_table_text(file);
  if (!text) return text.error();
  std::string_view rest = *text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) continue;
    line = line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
    if (const auto taken = take(number, line); !taken)
      return Error{taken.error().kind, fmt::format("{}:{}: {}", file.string(), number, taken.error().message)};
  }
  return {};
}

/// Twelve numbers, the upper three rows of a rigid 4 × 4 transform, row by row.
Result<Pose> parse_transform(std::string_view line) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
  Eigen::Index count = 0;
  while (!line.empty()) {
    const std::size_t end = line.find_first_of(" \t");
    const auto number = parse_number(line.substr(0, end));
    if (!number) return number.error();
    if (count < 12) matrix.data()[count] = *number;
    ++count;
    line.remove_prefix(end == std::string_view::npos ? line.size() : end);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  }
  if (count != 12)
    return Error{ErrorKind::bad_data, fmt::format("expected the 12 numbers of a 3 x 4 transform, found {}", count)};
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  const double skew = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(skew < 1e-3) || rotation.determinant() < 0.0 || !(matrix.col(3).cwiseAbs().maxCoeff() < kTableMaxCoordinate_m))
    return Error{ErrorKind::bad_data, fmt::format("expected a rigid transform (orthonormal within 1e-3), found {:.3g} "
                                                  "off and determinant {:.3g}",
                                                  skew, rotation.determinant())};
  return Pose{matrix.col(3), Eigen::Quaterniond(rotation).normalized()};
}

Result<Pose> read_T_camera_velodyne(const std::filesystem::path& file) {
  std::optional<Pose> T_camera_velodyne;
  const auto read = for_each_line(file, [&](std::size_t, std::string_view line) -> Status {
    if (!line.starts_with("Tr:")) return {};
    line.remove_prefix(3);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const auto pose = parse_transform(line);
    if (!pose) return pose.error();
    T_camera_velodyne = *pose;
    return {};
  });
  if (!read) return read.error();
  if (!T_camera_velodyne)
    return Error{ErrorKind::bad_data,
                 file.string() + ": expected a line 'Tr: <12 numbers>' (Velodyne to camera), found none"};
  return *T_camera_velodyne;
}

Result<std::vector<Time>> read_times(const std::filesystem::path& file) {
  std::vector<Time> times;
  const auto read = for_each_line(file, [&](std::size_t, std::string_view line) -> Status {
    const auto time = parse_seconds(line);
    if (!time || std::abs(to_seconds(*time)) > kTableMaxSeconds)
      return Error{ErrorKind::bad_data, fmt::format("expected decimal seconds, found '{}'", line.substr(0, 40))};
    if (!times.empty() && Time(*time) <= times.back())
      return Error{ErrorKind::bad_data,
                   fmt::format("expected a time above {} s, found {}: times must increase",
                               format_seconds(times.back().time_since_epoch()), line.substr(0, 40))};
    times.emplace_back(*time);
    return {};
  });
  if (!read) return read.error();
  return times;
}

Result<std::vector<Pose>> read_camera_poses(const std::filesystem::path& file) {
  std::vector<Pose> poses;
  const auto read = for_each_line(file, [&](std::size_t, std::string_view line) -> Status {
    const auto pose = parse_transform(line);
    if (!pose) return pose.error();
    poses.push_back(*pose);
    return {};
  });
  if (!read) return read.error();
  return poses;
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
  const auto times = read_times(directory / "times.txt");
  if (!times) return times.error();
  const auto cameras = read_camera_poses(directory / "poses.txt");
  if (!cameras) return cameras.error();
  const auto T_camera_velodyne = read_T_camera_velodyne(directory / "calib.txt");
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
  return make_file_source({directory.string(), std::move(frames), std::move(*track), std::move(cloud)}, window);
}

}  // namespace scree::drivers
