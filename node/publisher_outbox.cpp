#include "node/publisher_outbox.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace scree::node {

bool Outbox::flush(PublisherCounters& counters) {
  std::array<std::span<const std::uint8_t>, kCapacity> views;
  std::size_t done = 0;
  bool open = true;
  while (done < size_ && open) {
    for (std::size_t i = done; i < size_; ++i) views[i] = datagrams_[i].view();
    const auto sent = socket_->send(std::span(views).subspan(done, size_ - done), to_ ? &*to_ : nullptr);
    for (std::size_t i = done; i < done + sent.datagrams; ++i) counters.bytes += datagrams_[i].size;
    counters.datagrams += sent.datagrams;
    done += sent.datagrams;
    if (sent.outcome == UdpSocket::Outcome::blocked) {
      ++counters.send_blocked;
      open = false;
    } else if (sent.outcome != UdpSocket::Outcome::all) {
      ++counters.send_errors;
      if (sent.outcome == UdpSocket::Outcome::too_long && !error_)
        error_ = Error{ErrorKind::bad_config,
                       fmt::format("publish.destination: expected a path that takes UDP payloads of {} bytes "
                                   "unfragmented, found that {} bytes are too long for it",
                                   protocol::kMaxDatagramBytes, datagrams_[done].size)};
      ++done;
    }
  }
  // what the kernel did not take moves to the front; at most a few, and rarely
  std::copy(datagrams_.begin() + static_cast<std::ptrdiff_t>(done),
            datagrams_.begin() + static_cast<std::ptrdiff_t>(size_), datagrams_.begin());
  size_ -= done;
  return open;
}

}  // namespace scree::node
