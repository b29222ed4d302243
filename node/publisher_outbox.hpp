#pragma once
// Numbers datagrams, gathers them and hands them to the kernel many at a time.

#include <optional>
#include <vector>

#include "node/protocol.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

class Outbox {
 public:
  static constexpr std::size_t kCapacity = 64;

  struct Counters {
    std::uint64_t datagrams = 0;     ///< handed to the kernel
    std::uint64_t bytes = 0;         ///< of these
    std::uint64_t send_errors = 0;   ///< refused by the kernel and gone
    std::uint64_t send_blocked = 0;  ///< times that the kernel's buffer was full; what was left waits
  };

  explicit Outbox(UdpSocket socket) : socket_(std::move(socket)), datagrams_(kCapacity) {}

  /// Encodes with the next sequence number. There must be room().
  template <class Message>
  void add(protocol::Header header, const Message& message) {
    header.seq = next_seq_++;
    protocol::encode(header, message, datagrams_[size_++]);
  }
  std::size_t room() const { return kCapacity - size_; }
  bool empty() const { return size_ == 0; }

  /// Sends what it holds. False when the kernel takes no more for now.
  bool flush();

  const Counters& counters() const { return counters_; }
  /// Set for good once a datagram was larger than the path takes (DF is set): a configuration error.
  const std::optional<Error>& error() const { return error_; }

 private:
  UdpSocket socket_;
  std::vector<protocol::Datagram> datagrams_;
  std::size_t size_ = 0;
  std::uint64_t next_seq_ = 1;
  Counters counters_;
  std::optional<Error> error_;
};

}  // namespace scree::node
