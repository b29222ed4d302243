#pragma once
// Where frames come from. A Source is used by one thread.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/result.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::drivers {

enum class Origin : std::uint8_t { live = 0, replay = 1, sim = 2, hil = 3 };  ///< the numbers are the wire's

/// End of stream, a timeout, a lost device and a bad frame are values, not errors.
struct SourceEvent {
  enum class Kind : std::uint8_t {
    frame,
    timeout,
    end_of_stream,
    skipped,  ///< a frame that cannot be used
    notice,   ///< something happened to the device: it came, it went
  };
  Kind kind = Kind::timeout;
  std::shared_ptr<const RangeFrame> frame;  ///< for Kind::frame
  /// for Kind::skipped: object, expected, found; for Kind::frame: a warning, mostly empty; for Kind::notice: what
  std::string message;
};

/// What a source counts beside the frames that it delivers and skips, by name. Copied without allocation.
class SourceCounters {
 public:
  struct Item {
    const char* name = "";
    std::uint64_t value = 0;
  };
  void add(const char* name, std::uint64_t value) {
    if (size_ < items_.size()) items_[size_++] = {name, value};
  }
  std::span<const Item> items() const { return std::span(items_).first(size_); }

 private:
  std::array<Item, 24> items_{};
  std::size_t size_ = 0;
};

class Source {
 public:
  virtual ~Source() = default;
  /// Waits at most `timeout` for a frame. An Error means that the source cannot go on.
  virtual Result<SourceEvent> next(std::chrono::milliseconds timeout) = 0;
  /// What the frames up to now are. A device may say of itself that it is simulated only once it speaks.
  virtual Origin origin() const = 0;
  virtual std::string name() const = 0;
  /// Frames a finite source will deliver, where it knows.
  virtual std::optional<std::size_t> frame_count() const { return std::nullopt; }
  virtual SourceCounters counters() const { return {}; }
};

}  // namespace scree::drivers
