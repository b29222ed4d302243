#pragma once
// The sending end of a frame stream: what a simulated device does with its frames.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::drivers {

struct StreamServerCounters {
  std::uint64_t readers = 0;          ///< that came
  std::uint64_t readers_refused = 0;  ///< beyond kMaxReaders at a time
  std::uint64_t sent = 0;             ///< frames handed over whole, for each reader
  std::uint64_t unread = 0;           ///< frames that came while nobody was connected
  std::uint64_t superseded = 0;       ///< frames that a reader did not get because it was still taking an earlier one
  std::uint64_t broken = 0;           ///< frames that a reader left in the middle of
};

/// Sends each message whole or not at all to everyone who is connected. Never blocks, has no thread: serve() must be
/// called every few milliseconds.
class StreamServer {
 public:
  static constexpr std::size_t kMaxReaders = 8;

  /// Errors: usage (the address), unavailable.
  static Result<StreamServer> open(const std::string& address);

  /// With the port that the kernel chose, where it did.
  const StreamAddress& address() const { return address_; }
  /// Takes in who has come, sends on what is under way, lets go of who left.
  void serve();
  /// Begins to send `message` to everyone who has taken the one before whole.
  void send(std::shared_ptr<const std::vector<std::uint8_t>> message);

  std::size_t readers() const { return readers_.size(); }
  bool busy() const;  ///< something is under way
  const StreamServerCounters& counters() const { return counters_; }

 private:
  struct Reader {
    StreamSocket socket;
    std::shared_ptr<const std::vector<std::uint8_t>> message;  ///< under way; null = none
    std::size_t sent = 0;
  };
  StreamServer(StreamAddress address, StreamSocket listener)
      : address_(std::move(address)), listener_(std::move(listener)) {}
  bool push(Reader& reader);
  void push_all();

  StreamAddress address_;
  StreamSocket listener_;
  std::vector<Reader> readers_;
  StreamServerCounters counters_;
};

}  // namespace scree::drivers
