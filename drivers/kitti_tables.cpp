#include "drivers/kitti_tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <optional>

#include "drivers/table.hpp"

namespace scree::drivers {
namespace {

/// Calls `take(line)` for the lines that are not blank; its errors get "name:line: " before them.
Status for_each_line(std::string_view rest, const std::string& name,
                     const std::function<Status(std::string_view)>& take) {
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) continue;
    line = line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
    if (const auto taken = take(line); !taken)
      return Error{taken.error().kind, fmt::format("{}:{}: {}", name, number, taken.error().message)};
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

}  // namespace

Result<Pose> parse_kitti_calibration(std::string_view text, const std::string& name) {
  std::optional<Pose> T_camera_velodyne;
  const auto read = for_each_line(text, name, [&](std::string_view line) -> Status {
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
    return Error{ErrorKind::bad_data, name + ": expected a line 'Tr: <12 numbers>' (Velodyne to camera), found none"};
  return *T_camera_velodyne;
}

Result<std::vector<Time>> parse_kitti_times(std::string_view text, const std::string& name) {
  std::vector<Time> times;
  const auto read = for_each_line(text, name, [&](std::string_view line) -> Status {
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

Result<std::vector<Pose>> parse_kitti_poses(std::string_view text, const std::string& name) {
  std::vector<Pose> poses;
  const auto read = for_each_line(text, name, [&](std::string_view line) -> Status {
    const auto pose = parse_transform(line);
    if (!pose) return pose.error();
    poses.push_back(*pose);
    return {};
  });
  if (!read) return read.error();
  return poses;
}

}  // namespace scree::drivers
