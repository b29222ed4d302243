#include "node/publisher.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/random.h>

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
  if (const std::string reason = why_refused(*snapshot, s.cell_m); !reason.empty()) {
    if (s.counters.snapshots_refused++ == 0)
      spdlog::warn("map not published: {}; further ones are only counted", reason);
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
