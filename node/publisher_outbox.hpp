#pragma once
// Numbers datagrams, gathers them and hands them to the kernel many at a time.

#include <memory>
#include <optional>
#include <vector>

#include "node/protocol.hpp"
#include "node/published_map.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

class Outbox {
 public:
  static constexpr std::size_t kCapacity = 64;

  /// To `to`, or where the socket is connected to. `first_seq`: of the first datagram.
  Outbox(std::shared_ptr<UdpSocket> socket, std::optional<Endpoint> to, std::uint64_t first_seq)
      : socket_(std::move(socket)), to_(to), datagrams_(kCapacity), next_seq_(first_seq) {}

  /// Encodes with the next sequence number, and signs with `key` if there is one. There must be room().
  template <class Message>
  void add(protocol::Header header, const Message& message, const protocol::Key* key) {
    header.seq = next_seq_++;
    protocol::encode(header, message, datagrams_[size_++], key);
  }
  std::size_t room() const { return kCapacity - size_; }
  bool empty() const { return size_ == 0; }
  std::uint64_t next_seq() const { return next_seq_; }

  /// Sends what it holds, and counts. False when the kernel takes no more for now.
  bool flush(PublisherCounters& counters);

  /// Set for good once a datagram was larger than the path takes (DF is set): a configuration error.
  const std::optional<Error>& error() const { return error_; }

 private:
  std::shared_ptr<UdpSocket> socket_;
  std::optional<Endpoint> to_;
  std::vector<protocol::Datagram> datagrams_;
  std::size_t size_ = 0;
  std::uint64_t next_seq_;
  std::optional<Error> error_;
};

}  // namespace scree::node
