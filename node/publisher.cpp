#include "node/publisher.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <sys/random.h>
#include <thread>

#include "node/publisher_schedule.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {
namespace {

Result<std::uint64_t> random_boot_id() {
  std::uint64_t id = 0;
  while (id == 0)
    if (getrandom(&id, sizeof id, 0) != static_cast<ssize_t>(sizeof id) && errno != EINTR)
      return Error{ErrorKind::unavailable, fmt::format("boot_id: getrandom failed: {}", std::strerror(errno))};
  return id;
}

Status check_name(const std::string& key, const std::string& name) {
  if (protocol::valid_name(name)) return {};
  return Error{ErrorKind::bad_config,
               fmt::format("publish.{}: expected 1 … {} bytes without control characters, found '{}'", key,
                           protocol::kNameBytes - 1, name)};
}

}  // namespace

Publisher::Publisher(std::unique_ptr<State> state) : state_(std::move(state)) {}
Publisher::~Publisher() = default;

Result<std::unique_ptr<Publisher>> Publisher::open(const config::PublishSettings& settings, drivers::Origin origin,
                                                   double cell_m, std::uint32_t config_hash) {
  const std::string what = "publish.destination";
  const auto destination = parse_endpoint(settings.destination, what);
  if (!destination) return destination.error();
  if (destination->port == 0 || destination->any_address())
    return Error{ErrorKind::usage, fmt::format("{}: expected an address and a port of a receiver, found '{}'", what,
                                               settings.destination)};
  for (const auto& [key, name] : {std::pair{"frame_name", &settings.frame_name}, {"node_name", &settings.node_name}})
    if (Status good = check_name(key, *name); !good) return good.error();
  if (settings.datagrams_per_s < 1 || settings.refresh_ms < 1)
    return Error{ErrorKind::bad_config,
                 fmt::format("publish: expected datagrams_per_s and refresh_ms of at least 1, found {} and {}",
                             settings.datagrams_per_s, settings.refresh_ms)};
  auto boot_id = random_boot_id();
  if (!boot_id) return boot_id.error();
  auto socket = UdpSocket::connect_to(*destination, what);
  if (!socket) return socket.error();
  auto state = std::make_unique<State>(std::move(*socket), settings, origin, cell_m, config_hash);
  state->base.boot_id = *boot_id;
  return std::unique_ptr<Publisher>(new Publisher(std::move(state)));
}

void Publisher::submit(std::shared_ptr<const mapping::MapSnapshot> snapshot) {
  if (!snapshot) return;
  State& s = *state_;
  ++s.counters.snapshots;
  const LatticeWindow& window = snapshot->window;
  if (window.rows <= 0 || window.columns <= 0 || tiles_touched(window).tiles() > protocol::kMaxWindowTiles ||
      snapshot->cell_m != s.cell_m) {
    ++s.counters.snapshots_refused;
    return;
  }
  if (s.book.has_pending()) ++s.counters.snapshots_superseded;
  s.book.update(*snapshot);
  if (!s.has_map || s.window != window) s.announced_window = false;
  s.has_map = true;
  s.window = window;
  s.revision = snapshot->revision;
  s.data_time = snapshot->data_time;
  s.received = snapshot->received;
  s.manifest_wanted = true;
}

Duration Publisher::tick(MonotonicTime now, const NodeStatus& status) {
  return state_->tick(now, status);
}

Status Publisher::finish(const NodeStatus& status, protocol::ByeReason reason) {
  constexpr Duration kShort = std::chrono::milliseconds(5);
  State& s = *state_;
  const double needed_s = static_cast<double>(s.book.blocks()) / s.bucket.per_second();
  const MonotonicTime deadline = MonotonicClock::now() + std::chrono::seconds(1) + from_seconds(2.0 * needed_s);
  s.book.mark_all_pending();
  s.next_announce = {};  // a receiver must know the window before the last tiles come
  s.manifest_wanted = true;
  for (;;) {
    const Duration due = s.tick(MonotonicClock::now(), status);
    if (!s.book.has_pending() && s.outbox.empty() && !(s.has_map && s.manifest_wanted)) break;
    if (MonotonicClock::now() > deadline) break;
    std::this_thread::sleep_for(std::clamp<Duration>(due, std::chrono::microseconds(200), kShort));
  }
  const bool complete = !s.book.has_pending();
  if (s.make_room(1)) s.send_heartbeat(MonotonicClock::now());
  for (int copy = 0; copy < 3; ++copy) {
    if (copy > 0) std::this_thread::sleep_for(kShort);
    if (s.make_room(1)) s.send_bye(MonotonicClock::now(), reason, copy);
    s.outbox.flush();
  }
  s.collect_counters();
  if (s.outbox.error()) return *s.outbox.error();
  if (complete && s.outbox.empty()) return {};
  return Error{ErrorKind::io,
               fmt::format("publish.destination {}: expected to send the last map within {:.1f} s, found the "
                           "socket blocked or the pacing of {} datagrams/s too slow",
                           s.settings.destination, 1.0 + 2.0 * needed_s, s.settings.datagrams_per_s)};
}

const PublisherCounters& Publisher::counters() const {
  return state_->counters;
}

const std::optional<Error>& Publisher::error() const {
  return state_->outbox.error();
}

std::uint64_t Publisher::boot_id() const {
  return state_->base.boot_id;
}

}  // namespace scree::node
