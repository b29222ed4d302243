#pragma once
// Recordings on disk: the directory format of Scree, KITTI odometry, PCD directories and single range files.
// recording.yaml itself is read by config/ (YAML is parsed in one place) and arrives here as a RecordingDescription.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/frame/pose_track.hpp"
#include "drivers/frame/sensor.hpp"
#include "drivers/perceptron_file.hpp"
#include "drivers/source.hpp"

namespace scree::drivers {

/// recording.yaml.
struct RecordingDescription {
  Origin origin = Origin::live;
  SensorConfig sensor;
};

struct ReplayWindow {
  Duration start{0};                 ///< skip frames before first frame + start
  std::optional<Duration> duration;  ///< stop after this much data time
};

enum class RecordedPoses : std::uint8_t {
  needed,
  ignored,  ///< poses.csv is not read and need not exist; every frame has the identity
};

/// frames.csv, frames/ and poses.csv beside `description`. Errors: no_input (a missing file), bad_data (a table that
/// cannot be read, poses that cover no frame). One bad frame is Kind::skipped; no good frame at all is the error
/// bad_data at the end of the stream.
Result<std::unique_ptr<Source>> open_recording(const std::filesystem::path& directory, RecordingDescription description,
                                               ReplayWindow window, RecordedPoses poses = RecordedPoses::needed);

/// KITTI odometry layout: velodyne/*.bin, times.txt, poses.txt with calib.txt (camera poses, Tr).
Result<std::unique_ptr<Source>> open_kitti(const std::filesystem::path& directory, const SensorConfig& sensor,
                                           ReplayWindow window);

/// A directory of *.pcd (sorted by name) with poses.csv; frame i is taken at the time of pose i, or at the times of
/// frames.csv where that exists.
Result<std::unique_ptr<Source>> open_pcd_directory(const std::filesystem::path& directory, const SensorConfig& sensor,
                                                   ReplayWindow window);

/// One range file: USF geometry, or CMU by its size; identity body pose; sensor axes turned to REP-103 unless
/// `sensor` says where the sensor sits. Errors: no_input, bad_data (not a range file), bad_config (a sensor that such a
/// file cannot come from).
Result<std::unique_ptr<Source>> open_range_file(const std::filesystem::path& file, std::optional<SensorConfig> sensor);

/// Several recordings in one directory, each in a folder of its own, whose frames come in the order of order.csv (what
/// `scree run --record` writes of a node with several sources). `describe` reads a folder's recording.yaml. Errors:
/// those of open_recording, bad_data (order.csv names a frame that its recording does not have).
using Describe = std::function<Result<RecordingDescription>(const std::filesystem::path& folder)>;
Result<std::unique_ptr<Source>> open_ordered_recordings(const std::filesystem::path& directory,
                                                        const Describe& describe, ReplayWindow window,
                                                        RecordedPoses poses = RecordedPoses::needed);
/// Whether `directory` holds such recordings.
bool has_ordered_recordings(const std::filesystem::path& directory);

enum class PoseErrors : std::uint8_t { unknown, recorded };  ///< of poses.csv: with columns of variances

/// A directory that is new or empty, made if need be: what someone recorded before is never mixed with what comes now.
/// Errors: cannot_create.
Status claim_directory(const std::filesystem::path& directory);

/// Writes the directory format, frame by frame; recording.yaml's text is made by config/ and handed in. A row is
/// written behind what it names and handed to the kernel at once: a process that is killed loses at most the frame that
/// it was writing.
class RecordingWriter {
 public:
  static Result<RecordingWriter> create(const std::filesystem::path& directory, const std::string& recording_yaml,
                                        PoseErrors pose_errors = PoseErrors::unknown);
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();

  /// Raw counts of one frame, rows × columns: `.perc` for Perceptron kinds, 16-bit `.pgm` for pinhole.
  Status add_raw_frame(ProjectionKind kind, const Grid<std::uint16_t>& raw, Time time, std::uint64_t sequence);
  /// The same with the reflectance of Perceptron words at `shift`.
  Status add_range_file(const RangeFile& file, int shift, Time time, std::uint64_t sequence);
  /// float32 x y z intensity in sensor axes.
  Status add_cloud_frame(const std::vector<Eigen::Vector4f>& points_sensor, Time time, std::uint64_t sequence);
  Status add_pose(const StampedPose& pose);
  /// Several, written together; all or none. `variance` only with PoseErrors::recorded.
  Status add_poses(std::span<const StampedPose> poses, const PoseVariance& variance);
  std::optional<Time> last_frame() const;
  std::optional<Time> last_pose() const;
  std::size_t frame_count() const;
  /// Flushes and closes; errors that buffered writes hid come out here.
  Status finish();

 private:
  struct State;
  explicit RecordingWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::drivers
