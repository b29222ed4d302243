#include "node/publisher.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "node/publisher_state.hpp"
#include "node/random_id.hpp"

namespace scree::node {
namespace {

constexpr std::size_t kMostUnderWay = 64;

Status check_name(const std::string& key, const std::string& name) {
  if (protocol::valid_name(name)) return {};
  return Error{ErrorKind::bad_config,
               fmt::format("publish.{}: expected 1 … {} bytes without control characters, found '{}'", key,
                           protocol::kNameBytes - 1, name)};
}

Status check_settings(const config::PublishSettings& settings) {
  for (const auto& [key, name] : {std::pair{"frame_name", &settings.frame_name}, {"node_name", &settings.node_name}})
    if (Status good = check_name(key, *name); !good) return good;
  if (settings.datagrams_per_s >= 1 && settings.refresh_ms >= 1 && settings.max_subscribers >= 0) return {};
  return Error{ErrorKind::bad_config,
               fmt::format("publish: expected datagrams_per_s and refresh_ms of at least 1 and max_subscribers of at "
                           "least 0, found {}, {} and {}",
                           settings.datagrams_per_s, settings.refresh_ms, settings.max_subscribers)};
}

/// Empty when the snapshot can be published.
std::string why_refused(const mapping::MapSnapshot& snapshot, double cell_m) {
  const LatticeWindow& window = snapshot.window;
  if (window.rows <= 0 || window.columns <= 0)
    return fmt::format("expected a window of cells, found {} × {}", window.columns, window.rows);
  if (const auto tiles = tiles_touched(window).tiles(); tiles > protocol::kMaxWindowTiles)
    return fmt::format("expected a window of at most {} tiles, found {}", protocol::kMaxWindowTiles, tiles);
  if (snapshot.cell_m != cell_m)
    return fmt::format("expected cells of {} m as announced, found {} m", cell_m, snapshot.cell_m);
  return {};
}

}  // namespace

Result<protocol::KeyRing> make_key_ring(const std::vector<config::KeySettings>& keys) {
  protocol::KeyRing ring;
  for (const config::KeySettings& key : keys)
    if (!ring.add({key.id, key.bytes}))
      return Error{ErrorKind::bad_config,
                   fmt::format("publish.keys: expected at most {} keys with different ids from 1, found {} with the id "
                               "{} among them",
                               protocol::KeyRing::kCapacity, keys.size(), key.id)};
  return ring;
}

Publisher::State::State(PublishedMap published, std::shared_ptr<UdpSocket> fixed_socket, const Endpoint& destination,
                        const CookieJar& cookies, std::shared_ptr<UdpSocket> to_clients)
    : map(std::move(published)),
      subscriptions(static_cast<std::size_t>(map.settings.max_subscribers), cookies, destination),
      clients(std::move(to_clients)),
      streams(subscriptions.slots()) {
  StreamWish everything;
  everything.datagrams_per_s = map.settings.datagrams_per_s;
  streams[0].emplace(std::move(fixed_socket), std::nullopt, everything, first_seq, map);
  under_way.reserve(kMostUnderWay);
}

Publisher::Publisher(std::unique_ptr<State> state) : state_(std::move(state)) {}
Publisher::~Publisher() = default;

Result<std::unique_ptr<Publisher>> Publisher::open(const config::PublishSettings& settings, drivers::Origin origin,
                                                   double cell_m, std::uint32_t config_hash,
                                                   std::shared_ptr<UdpSocket> clients) {
  const std::string what = "publish.destination";
  const auto destination = parse_endpoint(settings.destination, what);
  if (!destination) return destination.error();
  if (destination->port == 0 || destination->any_address())
    return Error{ErrorKind::usage, fmt::format("{}: expected an address and a port of a receiver, found '{}'", what,
                                               settings.destination)};
  if (Status good = check_settings(settings); !good) return good.error();
  auto keys = make_key_ring(settings.keys);
  if (!keys) return keys.error();
  const auto boot_id = random_id("boot_id");
  if (!boot_id) return boot_id.error();
  const auto cookies = CookieJar::open();
  if (!cookies) return cookies.error();
  auto socket = UdpSocket::connect_to(*destination, what, {settings.multicast_ttl, settings.multicast_interface});
  if (!socket) return socket.error();
  PublishedMap map;
  map.settings = settings;
  map.settings.keys.clear();  // the ring has them
  map.cell_m = cell_m;
  map.keys = *keys;
  map.base.boot_id = *boot_id;
  map.base.origin = origin;
  map.base.stream_id = settings.stream_id;
  map.base.config_hash = config_hash;
  return std::unique_ptr<Publisher>(new Publisher(std::make_unique<State>(
      std::move(map), std::make_shared<UdpSocket>(std::move(*socket)), *destination, *cookies, std::move(clients))));
}

void Publisher::submit(const std::shared_ptr<const mapping::MapSnapshot>& snapshot,
                       std::optional<MonotonicTime> taken) {
  if (!snapshot) return;
  State& s = *state_;
  PublisherCounters& counters = s.map.counters;
  ++counters.snapshots;
  if (const std::string reason = why_refused(*snapshot, s.map.cell_m); !reason.empty()) {
    if (counters.snapshots_refused++ == 0) spdlog::warn("map not published: {}; further ones are only counted", reason);
    return;
  }
  if (s.fixed().queue().has_pending()) ++counters.snapshots_superseded;
  const bool moved = !s.map.has_map || s.map.window != snapshot->window;
  s.map.take(*snapshot);
  for (auto& stream : s.streams)
    if (stream) stream->note_map(s.map, moved);
  if (s.under_way.size() == kMostUnderWay) s.under_way.erase(s.under_way.begin());
  s.under_way.push_back({s.map.generation, taken.value_or(snapshot->received)});
}

void Publisher::add_pose(const protocol::PoseMessage& pose, MonotonicTime delivered) {
  state_->map.poses.add({pose, delivered});
}

Duration Publisher::State::tick(MonotonicTime now, const NodeStatus& status) {
  map.status = status;
  map.look_at_system(now);
  expire_leases(now);
  Duration next = kHeartbeatPeriod;
  for (auto& stream : streams)
    if (stream) next = std::min(next, stream->tick(now, map));
  measure_latency(now);
  if (const auto expiry = subscriptions.next_expiry()) next = std::clamp<Duration>(*expiry - now, Duration{0}, next);
  map.counters.cells_saturated = map.book.quantisation().saturated;
  return next;
}

void Publisher::State::measure_latency(MonotonicTime now) {
  const std::uint64_t out = fixed().generation_out(map);
  auto done = under_way.begin();
  for (; done != under_way.end() && done->generation <= out; ++done) map.latency.add(now - done->taken);
  under_way.erase(under_way.begin(), done);
}

Duration Publisher::tick(MonotonicTime now, const NodeStatus& status) {
  return state_->tick(now, status);
}

const PublisherCounters& Publisher::counters() const {
  return state_->map.counters;
}
const SubscriptionCounters& Publisher::subscriptions() const {
  return state_->subscriptions.counters;
}
std::size_t Publisher::subscribers() const {
  return state_->subscriptions.active();
}
const LatencyHistogram& Publisher::latency() const {
  return state_->map.latency;
}
const std::optional<Error>& Publisher::error() const {
  return state_->streams[0]->outbox().error();
}
std::uint64_t Publisher::boot_id() const {
  return state_->map.base.boot_id;
}

}  // namespace scree::node
