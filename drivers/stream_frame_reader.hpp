#pragma once
// Messages of a frame stream → range frames.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/frame_stream_decoder.hpp"

namespace scree::drivers::stream {

/// What became of a good message.
enum class Taken : std::uint8_t { frame, geometry, ignored_type, bad_geometry, no_geometry, bad_frame, no_pose };
inline constexpr std::size_t kTakenKinds = 7;

/// Errors are faults of the configuration: the device is not the one that was configured. After a first good frame they
/// are the device's: the geometry is refused, and its frames are.
using SensorFor = std::function<Result<SensorConfig>(const SensorConfig& told)>;

/// Keeps the geometry from one message to the next. One thread.
class FrameReader {
 public:
  /// `sensor_for` turns what the device says into what is used. `poses_needed`: a frame that does not bring a pose for
  /// every row is of no use; otherwise poses are not looked at and every row has the identity.
  FrameReader(SensorFor sensor_for, bool poses_needed)
      : sensor_for_(std::move(sensor_for)), poses_needed_(poses_needed) {}

  /// Fills `frame` for Taken::frame (metres along the ray, NaN for the invalid code and for returns below the sensor's
  /// min_reflectance; the counts as the device told them, reflectance with 4-byte words); `frame` is unspecified
  /// otherwise and reason() says why. No allocation when the geometry is that of the frame before. Errors: those of
  /// `sensor_for`.
  Result<Taken> take(const Message& message, RangeFrame& frame);

  /// For the last message that was neither frame nor geometry: what was expected and what was found.
  const std::string& reason() const { return reason_; }
  const std::string& device() const { return device_; }
  std::uint64_t taken(Taken kind) const { return counts_[static_cast<std::size_t>(kind)]; }
  /// Numbers of frames between one taken and the next of the same boot.
  std::uint64_t missing() const { return missing_; }

 private:
  Result<Taken> take_geometry(const Message& message);
  Taken take_frame(const Message& message, RangeFrame& frame);
  bool read_shape(std::span<const std::uint8_t> payload, std::uint8_t version_minor);
  bool read_times(RangeFrame& frame);
  bool read_poses();
  bool place_rows(RangeFrame& frame);
  bool read_words(RangeFrame& frame);
  void note_sequence(const Header& header);
  bool refuse(const char* what, const std::string& expected, const std::string& found);

  SensorFor sensor_for_;
  bool poses_needed_;
  std::optional<std::uint32_t> geometry_id_;
  int word_bytes_ = 2;
  int reflectance_shift_ = 0;  ///< as the device packs its words
  std::string device_;
  std::string geometry_fault_;  ///< of the last GEOMETRY, if it was refused
  std::shared_ptr<const Projection> projection_;
  std::shared_ptr<const SensorConfig> sensor_;
  // of the frame at hand
  std::span<const std::uint8_t> times_, poses_bytes_, words_;
  PoseVariance variance_;
  std::vector<StampedPose> poses_;
  std::string reason_;
  std::array<std::uint64_t, kTakenKinds> counts_{};
  std::optional<std::uint64_t> boot_id_;
  std::uint64_t sequence_ = 0;
  std::uint64_t missing_ = 0;
};

/// Whether a device of projection `found` is the one that was configured; both complete. Errors: bad_config naming
/// `name`, the parameter, expected and found.
Status check_same_projection(const std::string& name, const ProjectionConfig& expected, const ProjectionConfig& found);

}  // namespace scree::drivers::stream
