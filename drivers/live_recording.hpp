#pragma once
// A recording of frames as they were mapped: replayed, it gives the same map.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/result.hpp"
#include "drivers/frame/range_frame.hpp"
#include "drivers/recording.hpp"

namespace scree::drivers {

/// A frame and what it was mapped with.
struct MappedFrame {
  const RangeFrame& frame;
  std::span<const Pose> T_map_body;  ///< one a row: those that were used
  PoseVariance pose_variance;
  Origin origin = Origin::live;
};

/// Created with the first frame, whose sensor is the recording's. One thread.
class LiveRecording {
 public:
  /// recording.yaml of a description: YAML is config's.
  using Describe = std::function<std::string(const RecordingDescription&)>;

  /// Nothing is written before the first frame; `directory` is claimed by the caller.
  LiveRecording(std::filesystem::path directory, Describe describe)
      : directory_(std::move(directory)), describe_(std::move(describe)) {}

  /// Writes the poses, then the frame, then its row. Errors: bad_data for a frame that the format cannot hold (no
  /// counts, another sensor than the first frame's, times that do not increase, poses that differ within a frame of one
  /// instant, a removed return without a count that says so): the recording goes on without it; io and cannot_create:
  /// it cannot.
  Status add(const MappedFrame& mapped);
  Status finish();

  std::uint64_t frames() const { return writer_ ? writer_->frame_count() : 0; }
  /// Frames whose rows were stamped otherwise than time + row · row_period, and are recorded at those times: the map of
  /// the replay is the same, but for its data time.
  std::uint64_t restamped() const { return restamped_; }

 private:
  Status begin(const MappedFrame& mapped);
  Status check(const MappedFrame& mapped);
  Status add_poses(const MappedFrame& mapped);
  Status add_image(const RangeFrame& frame);

  std::filesystem::path directory_;
  Describe describe_;
  std::optional<RecordingWriter> writer_;
  std::shared_ptr<const SensorConfig> sensor_;  ///< of the frames up to now
  std::shared_ptr<const Projection> projection_;
  Origin origin_ = Origin::live;
  std::string description_;
  RangeFile file_;
  std::uint64_t restamped_ = 0;
};

}  // namespace scree::drivers
