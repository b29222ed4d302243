#include "node/listener.hpp"

#include <fmt/format.h>

#include "node/listener_assembly.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

struct Listener::State {
  UdpSocket socket;
  MapAssembly assembly;
};

Listener::Listener(std::unique_ptr<State> state) : state_(std::move(state)) {}
Listener::~Listener() = default;

Result<std::unique_ptr<Listener>> Listener::open(const std::string& address, std::set<drivers::Origin> accept,
                                                 std::optional<std::uint32_t> stream_id) {
  const std::string what = "listen address";
  const auto endpoint = parse_endpoint(address, what);
  if (!endpoint) return endpoint.error();
  if (endpoint->any_address())
    return Error{
        ErrorKind::usage,
        fmt::format("{}: expected one address of this machine, found '{}', which is all of them", what, address)};
  auto socket = UdpSocket::bind(*endpoint, what);
  if (!socket) return socket.error();
  return std::unique_ptr<Listener>(
      new Listener(std::make_unique<State>(State{std::move(*socket), MapAssembly(std::move(accept), stream_id)})));
}

Result<bool> Listener::poll(std::chrono::milliseconds timeout) {
  const auto count = state_->socket.receive(timeout, [&](std::span<const std::uint8_t> datagram, const Endpoint&) {
    (void)state_->assembly.accept(datagram, MonotonicClock::now());  // counted there
  });
  if (!count) return count.error();
  state_->assembly.set_overflowed(state_->socket.overflowed());
  state_->assembly.advance(MonotonicClock::now());
  return *count > 0;
}

std::uint16_t Listener::port() const {
  return state_->socket.local_port();
}
LinkState Listener::link() const {
  return state_->assembly.link();
}
bool Listener::ended() const {
  return state_->assembly.ended();
}
std::optional<protocol::ByeReason> Listener::bye_reason() const {
  return state_->assembly.bye_reason();
}
std::optional<drivers::Origin> Listener::origin() const {
  return state_->assembly.origin();
}
std::optional<drivers::Origin> Listener::refused_origin() const {
  return state_->assembly.refused_origin();
}
std::uint16_t Listener::health() const {
  return state_->assembly.health();
}
const ListenerCounters& Listener::counters() const {
  return state_->assembly.counters();
}
const std::optional<protocol::Announce>& Listener::announce() const {
  return state_->assembly.announce();
}
const std::optional<protocol::Heartbeat>& Listener::heartbeat() const {
  return state_->assembly.heartbeat();
}
std::shared_ptr<const mapping::MapSnapshot> Listener::map() const {
  return state_->assembly.map(MonotonicClock::now());
}
std::shared_ptr<const mapping::MapSnapshot> Listener::last_valid_map() const {
  return state_->assembly.last_valid_map(MonotonicClock::now());
}
std::uint64_t Listener::frames_in() const {
  return heartbeat() ? heartbeat()->frames_in : 0;
}
std::uint64_t Listener::frames_dropped() const {
  return heartbeat() ? heartbeat()->frames_dropped : 0;
}
std::uint32_t Listener::latency_p50_us() const {
  return heartbeat() ? heartbeat()->latency_p50_us : 0;
}
std::uint32_t Listener::latency_p99_us() const {
  return heartbeat() ? heartbeat()->latency_p99_us : 0;
}

}  // namespace scree::node
