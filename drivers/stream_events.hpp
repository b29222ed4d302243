#pragma once
// Bytes of a frame stream → events of a Source: what all that speak it (sockets, USB) have in common.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/result.hpp"
#include "drivers/frame_pool.hpp"
#include "drivers/source.hpp"
#include "drivers/stream_frame_reader.hpp"

namespace scree::drivers {

/// Decoder, reader, pool and counters of one stream, over all its connections. One thread.
class StreamEvents {
 public:
  /// `name` begins each message. `origin`: what the frames are unless the device says that it is simulated;
  /// `poses_needed` as in FrameReader.
  StreamEvents(std::string name, Origin origin, stream::SensorFor sensor_for, bool poses_needed)
      : name_(std::move(name)), origin_(origin), reader_(std::move(sensor_for), poses_needed) {}

  /// Bytes to be taken apart, in place of what was left of the last ones; they must stay until next() has none.
  void hear(std::span<const std::uint8_t> bytes) { left_ = bytes; }

  /// The next event in the bytes at hand, if there is one: Kind::frame or Kind::skipped. A FRAME whose payload is
  /// damaged is told before what followed it. Errors: those of `sensor_for`. No allocation of pixels once the pool is
  /// warm.
  Result<std::optional<SourceEvent>> next();

  /// Another connection: what is held of a message belongs to nothing that will follow. The geometry stays.
  void disconnect();

  /// sim from the first simulated frame on, for good, if it was live.
  Origin origin() const { return origin_; }
  const std::string& name() const { return name_; }
  SourceEvent notice(const std::string& what) const;
  /// Good FRAME messages so far, of whatever use: a device that says what it is and sends no frames is silent.
  std::uint64_t frames_heard() const { return frames_heard_; }
  /// bytes … frames_missing, as in docs/frame-stream.md.
  void add_counters(SourceCounters& out) const;

 private:
  Result<std::optional<SourceEvent>> take(const stream::Message& message);
  SourceEvent skipped(const std::string& why) const;

  std::string name_;
  Origin origin_;
  stream::Decoder decoder_;
  stream::FrameReader reader_;
  FramePool pool_;
  std::shared_ptr<RangeFrame> frame_;  ///< to be filled next
  std::span<const std::uint8_t> left_;
  std::optional<stream::Message> message_;  ///< decoded and not taken yet
  std::uint64_t told_refused_ = 0;
  std::uint64_t frames_heard_ = 0;
};

}  // namespace scree::drivers
