#pragma once
// Where frames come from. A Source is used by one thread.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::drivers {

enum class Origin : std::uint8_t { live = 0, replay = 1, sim = 2, hil = 3 };  ///< the numbers are the wire's

/// End of stream, a timeout and a bad frame are values, not errors.
struct SourceEvent {
  enum class Kind : std::uint8_t { frame, timeout, end_of_stream, skipped };
  Kind kind = Kind::timeout;
  std::shared_ptr<const RangeFrame> frame;  ///< for Kind::frame
  std::string message;  ///< for Kind::skipped: object, expected, found; for Kind::frame: a warning, mostly empty
};

class Source {
 public:
  virtual ~Source() = default;
  /// Waits at most `timeout` for a frame. An Error means that the source cannot go on.
  virtual Result<SourceEvent> next(std::chrono::milliseconds timeout) = 0;
  virtual Origin origin() const = 0;
  virtual std::string name() const = 0;
  /// Frames a finite source will deliver, where it knows.
  virtual std::optional<std::size_t> frame_count() const { return std::nullopt; }
};

}  // namespace scree::drivers
