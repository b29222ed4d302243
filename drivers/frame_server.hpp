#pragma once
// The sending end of a simulated device, whatever it is plugged into: a socket that speaks the frame stream
// (stream_server), or an emulated USB port (usbredir_server).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"

namespace scree::drivers {

using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

/// One frame in the forms in which a device hands it out.
struct ServedFrame {
  SharedBytes message = nullptr;  ///< GEOMETRY and FRAME of the frame stream
  SharedBytes image = nullptr;  ///< the counts alone, 16-bit little-endian, row-major; null = the device has no camera
  bool image_damaged = false;   ///< the device itself says so
};

struct FrameServerCounters {
  std::uint64_t readers = 0;          ///< that came
  std::uint64_t readers_refused = 0;  ///< beyond what can be served at a time
  std::uint64_t sent = 0;             ///< frames handed over whole, for each reader
  std::uint64_t unread = 0;           ///< frames that came while nobody was reading
  std::uint64_t superseded = 0;       ///< frames that a reader did not get because it was still taking an earlier one
  std::uint64_t broken = 0;           ///< frames that ended in the middle: the reader left, or a fault
};

/// What is wrong with the way to the readers while it lasts.
struct LinkState {
  bool unplugged = false;
  bool frozen = false;     ///< there, but neither delivers nor fails
  Duration frame_time{0};  ///< that a frame takes on its way; 0 = as little as it can

  /// Of a frame of `total` bytes that has been under way for `elapsed`: how many may have left. Whole at most.
  std::size_t allowed(std::size_t total, Duration elapsed) const;

  friend bool operator==(const LinkState&, const LinkState&) = default;
};

/// Hands each frame over whole or not at all to everyone who reads. Never blocks, has no thread: serve() must be called
/// every few milliseconds.
class FrameServer {
 public:
  virtual ~FrameServer() = default;

  /// Where it is, with the port that the kernel chose, where it did.
  virtual std::string address() const = 0;
  /// Takes in who has come, hands on what is under way, lets go of who left.
  virtual void serve() = 0;
  /// Begins to hand over `frame` to everyone who can take it.
  virtual void send(const ServedFrame& frame) = 0;
  virtual std::size_t readers() const = 0;
  virtual bool busy() const = 0;  ///< something is under way
  virtual const FrameServerCounters& counters() const = 0;

  virtual void set_link(const LinkState& link) = 0;
  /// Whether stall() and babble() mean something: USB alone.
  virtual bool has_endpoints() const { return false; }
  virtual void stall() {}   ///< the frame endpoint answers STALL until the host clears it
  virtual void babble() {}  ///< the next answer of the frame endpoint is larger than was asked for
};

/// What an emulated USB device says of itself.
struct ServedShape {
  std::string device;             ///< its name
  int rows = 0, columns = 0;      ///< of its images
  bool camera = false;            ///< its words are 16-bit counts: they go out as a V4L2 image too
  Duration frame_period{0};       ///< > 0
  std::size_t message_bytes = 0;  ///< of the largest message
};

/// `address` is unix:PATH, tcp:PORT or usbredir:PATH (QEMU's usb-redir, which listens there; retried for ever). Errors:
/// usage (the address; usbredir in a build without SCREE_WITH_USBREDIR), unavailable.
Result<std::unique_ptr<FrameServer>> open_frame_server(const std::string& address, const ServedShape& shape);

}  // namespace scree::drivers
