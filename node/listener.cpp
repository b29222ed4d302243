#include "node/listener.hpp"

#include <fmt/format.h>

#include "node/listener_assembly.hpp"
#include "node/listener_client.hpp"
#include "node/random_id.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

struct Listener::State {
  UdpSocket socket;
  MapAssembly assembly;
  std::optional<Endpoint> node;
  std::optional<NodeClient> client;

  void send(std::span<const std::uint8_t> datagram) { (void)socket.send(std::span(&datagram, 1), &*node); }
};

Listener::Listener(std::unique_ptr<State> state) : state_(std::move(state)) {}
Listener::~Listener() {
  State& s = *state_;
  if (s.client) s.client->end([&](std::span<const std::uint8_t> datagram) { s.send(datagram); });
}

Result<std::unique_ptr<Listener>> Listener::open(const std::string& address, std::set<drivers::Origin> accept,
                                                 std::optional<std::uint32_t> stream_id) {
  ListenerConfig config;
  config.address = address;
  config.accept = std::move(accept);
  config.stream_id = stream_id;
  return open(config);
}

Result<std::unique_ptr<Listener>> Listener::open(const ListenerConfig& config) {
  const std::string what = "listen address";
  const auto endpoint = parse_endpoint(config.address, what);
  if (!endpoint) return endpoint.error();
  if (endpoint->any_address())
    return Error{ErrorKind::usage,
                 fmt::format("{}: expected one address of this machine, found '{}', which is all of them", what,
                             config.address)};
  std::optional<Endpoint> node;
  std::optional<NodeClient> client;
  if (config.node) {
    const auto parsed = parse_endpoint(*config.node, "node address");
    if (!parsed) return parsed.error();
    if (parsed->port == 0 || parsed->any_address() || parsed->multicast() || !config.stream_id)
      return Error{ErrorKind::usage, fmt::format("node address: expected the address and port of one node, and the "
                                                 "number of its stream, found '{}'",
                                                 *config.node)};
    const auto boot_id = random_id("boot_id");
    if (!boot_id) return boot_id.error();
    node = *parsed;
    client.emplace(config.wish, *config.stream_id, *boot_id, config.keys);
  }
  auto socket = UdpSocket::bind(*endpoint, what, config.multicast_interface);
  if (!socket) return socket.error();
  return std::unique_ptr<Listener>(new Listener(std::make_unique<State>(
      State{std::move(*socket), MapAssembly(config.accept, config.stream_id, config.keys), node, std::move(client)})));
}

Result<bool> Listener::poll(std::chrono::milliseconds timeout) {
  State& s = *state_;
  const auto count = s.socket.receive(timeout, [&](std::span<const std::uint8_t> datagram, const Endpoint&) {
    (void)s.assembly.accept(datagram, MonotonicClock::now());  // counted there
  });
  if (!count) return count.error();
  s.assembly.set_overflowed(s.socket.overflowed());
  s.assembly.advance(MonotonicClock::now());
  if (s.client && !s.assembly.ended())
    s.client->tick(MonotonicClock::now(), std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()),
                   s.assembly, [&](std::span<const std::uint8_t> datagram) { s.send(datagram); });
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
const std::optional<protocol::PoseMessage>& Listener::pose() const {
  return state_->assembly.pose();
}
const ClientCounters* Listener::client() const {
  return state_->client ? &state_->client->counters() : nullptr;
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
