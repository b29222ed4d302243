#include "node/node_source.hpp"

#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <system_error>
#include <utility>

#include "config/loader.hpp"
#include "config/recording_file.hpp"
#include "drivers/simulator.hpp"
#include "drivers/stream_source.hpp"
#include "drivers/usb_source.hpp"
#include "drivers/v4l2_source.hpp"

namespace scree::node {
namespace {

using OpenedSource = Result<std::unique_ptr<drivers::Source>>;

/// recording.yaml of `directory` with the configuration's overrides of its sensor.
Result<drivers::RecordingDescription> describe(const std::filesystem::path& directory,
                                               const config::SensorSettings& sensor_settings) {
  auto description = config::read_recording(directory);
  if (!description) return description.error();
  auto sensor = config::effective_sensor(sensor_settings, description->sensor);
  if (!sensor) return sensor.error();
  description->sensor = *std::move(sensor);
  return description;
}

OpenedSource open_directory(const std::filesystem::path& directory, const drivers::ReplayWindow& window,
                            const config::SensorSettings& sensor_settings, config::PoseSource pose_source) {
  const auto poses =
      pose_source == config::PoseSource::recording ? drivers::RecordedPoses::needed : drivers::RecordedPoses::ignored;
  const auto of = [&](const std::filesystem::path& folder) { return describe(folder, sensor_settings); };
  if (drivers::has_ordered_recordings(directory)) return drivers::open_ordered_recordings(directory, of, window, poses);
  auto description = of(directory);
  if (!description) return description.error();
  return drivers::open_recording(directory, *std::move(description), window, poses);
}

/// A file's own default sensor is the driver's business, so single keys have nothing to override here.
OpenedSource open_file(const std::filesystem::path& file, const config::SensorSettings& settings) {
  if (!settings.sensor) return drivers::open_range_file(file, std::nullopt);
  if (!settings.has_whole_sensor())
    return Error{
        ErrorKind::bad_config,
        fmt::format("{}: expected a whole sensor (sensor.projection) for a single range file, found sensor.{} alone",
                    file.string(), settings.sensor_given.front())};
  return drivers::open_range_file(file, settings.sensor);
}

/// Formats of clouds that say nothing of their sensor.
Result<SensorConfig> cloud_sensor(const config::SensorSettings& settings) {
  SensorConfig sensor;
  sensor.projection.kind = ProjectionKind::cloud;
  return config::effective_sensor(settings, sensor);
}

/// The device's sensor with the configuration's overrides; a whole sensor in the configuration must be the device's.
Result<SensorConfig> stream_sensor(const config::SensorSettings& settings, const SensorConfig& told) {
  if (!settings.has_whole_sensor()) return config::effective_sensor(settings, told);
  const ProjectionConfig& given = settings.sensor->projection;
  const int rows = given.rows > 0 ? given.rows : told.projection.rows;
  const int columns = given.columns > 0 ? given.columns : told.projection.columns;
  auto expected = complete_projection(given, rows, columns);
  if (!expected) return Error{ErrorKind::bad_config, expected.error().message};
  if (const auto same = drivers::stream::check_same_projection("device", *expected, told.projection); !same)
    return same.error();
  SensorConfig sensor = *settings.sensor;
  sensor.projection = *std::move(expected);
  return sensor;
}

drivers::stream::SensorFor sensor_for(const config::SourceSettings& source) {
  return [source](const SensorConfig& told) { return stream_sensor(source, told); };
}

OpenedSource open_device_stream(const config::SourceSettings& source, const config::Settings& settings) {
  drivers::StreamSourceConfig stream;
  stream.address = source.address;
  stream.deadline = std::chrono::milliseconds(source.deadline_ms);
  stream.poses_needed = settings.pose.source == config::PoseSource::recording;
  stream.origin = settings.publish.origin;
  return drivers::open_stream(stream, sensor_for(source));
}

OpenedSource open_usb_scanner(const config::SourceSettings& source, const config::Settings& settings) {
  drivers::UsbSourceConfig usb;
  if (const auto id = config::parse_usb_id(source.usb_id)) {
    usb.vendor_id = id->vendor;
    usb.product_id = id->product;
  }
  usb.serial = source.serial;
  usb.deadline = std::chrono::milliseconds(source.deadline_ms);
  usb.poses_needed = settings.pose.source == config::PoseSource::recording;
  usb.origin = settings.publish.origin;
  return drivers::open_usb(usb, sensor_for(source));
}

/// A camera says nothing of its optics, nor of where it is: the configuration does, as its rules make sure.
OpenedSource open_camera(const config::SourceSettings& source, const config::Settings& settings) {
  drivers::V4l2SourceConfig camera;
  camera.device = source.device;
  camera.format = source.format;
  camera.rate_hz = source.rate_hz;
  camera.deadline = std::chrono::milliseconds(source.deadline_ms);
  camera.sensor = source.sensor.value_or(SensorConfig{});
  camera.origin = settings.publish.origin;
  return drivers::open_v4l2(camera);
}

OpenedSource open_simulated(const config::SourceSettings& source) {
  drivers::SimulatorConfig simulator;
  simulator.terrain = source.terrain;
  simulator.sensor = source.simulated_sensor;
  simulator.trajectory = source.trajectory;
  simulator.noise = source.noise;
  simulator.seed = source.seed;
  return drivers::simulated_source(simulator, true);
}

OpenedSource open_path(const std::string& path, const std::string& format, const drivers::ReplayWindow& window,
                       const config::SensorSettings& sensor, config::PoseSource poses) {
  std::error_code status;
  if (!std::filesystem::exists(path, status))
    return Error{ErrorKind::no_input, fmt::format("{}: expected a recording, found no such file or directory", path)};
  const bool is_directory = std::filesystem::is_directory(path, status);
  if (format == "auto") return is_directory ? open_directory(path, window, sensor, poses) : open_file(path, sensor);
  if (!is_directory)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a directory in the format {}, found a file", path, format)};
  const auto cloud = cloud_sensor(sensor);
  if (!cloud) return cloud.error();
  return format == "kitti" ? drivers::open_kitti(path, *cloud, window)
                           : drivers::open_pcd_directory(path, *cloud, window);
}

}  // namespace

OpenedSource open_input(const std::string& path, const std::string& format, const drivers::ReplayWindow& window,
                        const config::Settings& settings) {
  return open_path(path, format, window, settings, settings.pose.source);
}

OpenedSource open_live(const config::SourceSettings& source, const config::Settings& settings) {
  switch (source.kind) {
    case config::SourceKind::recording:
      return open_path(source.path, "auto", {}, source, settings.pose.source);
    case config::SourceKind::simulated:
      return open_simulated(source);
    case config::SourceKind::stream:
      return open_device_stream(source, settings);
    case config::SourceKind::usb:
      return open_usb_scanner(source, settings);
    case config::SourceKind::v4l2:
      return open_camera(source, settings);
    case config::SourceKind::none:
      break;
  }
  return Error{ErrorKind::bad_config,
               "configuration: source.kind: expected recording, simulated, stream, usb or v4l2 for `scree run`, found "
               "none"};
}

}  // namespace scree::node
