#include "drivers/recording.hpp"

#include <fmt/format.h>

#include "drivers/perceptron_file.hpp"
#include "drivers/recording_frame.hpp"
#include "drivers/recording_source.hpp"
#include "drivers/table.hpp"

namespace scree::drivers {
namespace {

Status check_directory(const std::filesystem::path& directory) {
  std::error_code failed;
  if (std::filesystem::is_directory(directory, failed)) return {};
  return Error{ErrorKind::no_input, directory.string() + ": expected a directory, found none"};
}

/// Rows of frames.csv as files of `directory`.
Result<std::vector<FrameEntry>> read_frames(const std::filesystem::path& directory, std::string_view folder,
                                            std::string* torn) {
  const auto text = read_table_text(directory / "frames.csv");
  if (!text) return text.error();
  const auto rows = parse_frames_table(*text, (directory / "frames.csv").string(), folder, torn);
  if (!rows) return rows.error();
  std::vector<FrameEntry> frames;
  for (const FrameRow& row : *rows) frames.push_back({directory / row.file, row.time, row.sequence});
  return frames;
}

/// The i-th file at the time of the i-th pose.
Result<std::vector<FrameEntry>> pair_with_poses(const std::filesystem::path& directory, const PoseTrack& poses) {
  const auto files = list_files(directory, ".pcd");
  if (!files) return files.error();
  if (files->size() != poses.poses().size())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected one pose for each of {} *.pcd files (there is no frames.csv), found {}",
                             (directory / "poses.csv").string(), files->size(), poses.poses().size())};
  std::vector<FrameEntry> frames;
  for (std::size_t i = 0; i < files->size(); ++i) frames.push_back({(*files)[i], poses.poses()[i].time, i});
  return frames;
}

/// The sensor of a file about which nothing is said: at the map's origin, its axes turned to REP-103 (x forward = z,
/// y left = x, z up = y), the first ambiguity interval assumed where nothing anchors it.
SensorConfig default_sensor(RangeFileLayout layout) {
  SensorConfig sensor;
  sensor.projection.kind =
      layout == RangeFileLayout::usf ? ProjectionKind::perceptron_usf : ProjectionKind::perceptron_cmu;
  sensor.T_body_sensor.rotation = Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5);
  sensor.filter.phase = PhasePolicy::first_interval;
  return sensor;
}

/// Whoever chose the sensor contradicts the file: that is a bad configuration, not bad data.
Status check_sensor(const std::filesystem::path& file, const SensorConfig& sensor) {
  if (std::error_code ignored; !std::filesystem::exists(file, ignored))
    return Error{ErrorKind::no_input, file.string() + ": expected a file, found none"};
  std::optional<RangeFileLayout> layout;
  if (file.extension() != ".pgm") {
    if (sensor.projection.kind == ProjectionKind::cloud && file.extension() != ".perc") return {};
    const auto range_file = read_range_file(file, {.lenient = sensor.projection.lenient});
    if (!range_file) return range_file.error();
    layout = range_file->layout;
  }
  const auto fits = check_file_kind(file.string(), layout, sensor.projection.kind);
  if (!fits) return Error{ErrorKind::bad_config, fits.error().message};
  return {};
}

}  // namespace

Result<std::unique_ptr<Source>> open_recording(const std::filesystem::path& directory, RecordingDescription description,
                                               ReplayWindow window, RecordedPoses recorded_poses) {
  if (const auto there = check_directory(directory); !there) return there.error();
  std::string torn;
  auto frames = read_frames(directory, "frames", &torn);
  if (!frames) return frames.error();
  if (const auto there = check_directory(directory / "frames"); !there) return there.error();
  auto poses = recorded_poses == RecordedPoses::needed ? read_pose_track(directory / "poses.csv")
                                                       : RecordedTrack{PoseTrack::fixed(Pose{}), {}, {}};
  if (!poses) return poses.error();
  if (torn.empty()) torn = std::move(poses->torn);
  return make_file_source({directory.string(), std::move(*frames), std::move(poses->poses),
                           std::move(description.sensor), std::move(poses->variances), std::move(torn)},
                          window);
}

Result<std::unique_ptr<Source>> open_pcd_directory(const std::filesystem::path& directory, const SensorConfig& sensor,
                                                   ReplayWindow window) {
  if (const auto there = check_directory(directory); !there) return there.error();
  auto poses = read_pose_track(directory / "poses.csv");
  if (!poses) return poses.error();
  std::error_code ignored;
  auto frames = std::filesystem::exists(directory / "frames.csv", ignored) ? read_frames(directory, "", nullptr)
                                                                           : pair_with_poses(directory, poses->poses);
  if (!frames) return frames.error();
  SensorConfig cloud = sensor;
  cloud.projection.kind = ProjectionKind::cloud;
  return make_file_source({directory.string(), std::move(*frames), std::move(poses->poses), std::move(cloud),
                           std::move(poses->variances), std::move(poses->torn)},
                          window);
}

Result<std::unique_ptr<Source>> open_range_file(const std::filesystem::path& file, std::optional<SensorConfig> sensor) {
  // A bad file, or a sensor that it cannot come from, is refused before anything is started for it.
  if (!sensor) {
    const auto range_file = read_range_file(file);
    if (!range_file) return range_file.error();
    sensor = default_sensor(range_file->layout);
  } else if (const auto fits = check_sensor(file, *sensor); !fits) {
    return fits.error();
  }
  return make_file_source({file.string(), {{file, Time{}, 0}}, PoseTrack::fixed(Pose{}), std::move(*sensor), {}, {}},
                          {});
}

}  // namespace scree::drivers
