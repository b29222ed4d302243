#pragma once
// A simulated device on a socket: what it sends is the frame stream.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "drivers/frame_server.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::drivers {

/// Sends each message whole or not at all to everyone who is connected. Unplugged, it closes every connection and does
/// not listen.
class StreamServer final : public FrameServer {
 public:
  static constexpr std::size_t kMaxReaders = 8;

  /// Errors: usage (the address), unavailable.
  static Result<StreamServer> open(const std::string& address);

  std::string address() const override { return to_string(address_); }
  void serve() override;
  void send(const ServedFrame& frame) override;
  std::size_t readers() const override { return readers_.size(); }
  bool busy() const override;
  const FrameServerCounters& counters() const override { return counters_; }
  void set_link(const LinkState& link) override;

 private:
  struct Reader {
    StreamSocket socket;
    SharedBytes message;  ///< under way; null = none
    std::size_t sent = 0;
    MonotonicTime began{};
  };
  StreamServer(StreamAddress address, StreamSocket listener)
      : address_(std::move(address)), listener_(std::move(listener)) {}
  bool push(Reader& reader);
  void push_all();

  StreamAddress address_;
  std::optional<StreamSocket> listener_;
  std::vector<Reader> readers_;
  LinkState link_;
  FrameServerCounters counters_;
};

}  // namespace scree::drivers
