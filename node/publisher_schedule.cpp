#include "node/publisher_schedule.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <sys/timex.h>
#include <unistd.h>

namespace scree::node {
namespace {

using protocol::Header;

/// Resident memory of this process; 0 where /proc does not tell.
std::uint64_t resident_bytes() {
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  unsigned long long pages = 0;
  if (std::fscanf(file, "%*u %llu", &pages) != 1) pages = 0;
  std::fclose(file);
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// The kernel says that something (NTP, PTP) disciplines the system clock.
bool clock_is_locked() {
  timex state{};
  const int answer = adjtimex(&state);
  return answer >= 0 && answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

template <class Unsigned>
Unsigned saturate(std::int64_t value) {
  return static_cast<Unsigned>(
      std::clamp<std::int64_t>(value, 0, static_cast<std::int64_t>(std::numeric_limits<Unsigned>::max())));
}

std::int64_t milliseconds(Duration duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

protocol::SensorState sensor_state(const NodeStatus& status) {
  if (status.frames_in == 0) return protocol::SensorState::waiting;
  if (status.health & protocol::kHealthSensorLost) return protocol::SensorState::lost;
  if (status.health & protocol::kHealthSensorStale) return protocol::SensorState::stale;
  return protocol::SensorState::ok;
}

}  // namespace

Publisher::State::State(UdpSocket socket, const config::PublishSettings& publish, drivers::Origin origin,
                        double cell_size_m, std::uint32_t config_hash)
    : settings(publish), cell_m(cell_size_m), outbox(std::move(socket)), bucket(publish.datagrams_per_s) {
  base.origin = origin;
  base.stream_id = publish.stream_id;
  base.config_hash = config_hash;
}

Header Publisher::State::header(MonotonicTime now) const {
  Header out = base;
  out.health = status.health;
  if (status.origin) out.origin = *status.origin;
  out.map_rev = revision;
  out.age_us = std::numeric_limits<std::uint32_t>::max();
  if (has_map) {
    out.t_data_ns = data_time.time_since_epoch().count();
    out.age_us = saturate<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(now - received).count());
  }
  return out;
}

void Publisher::State::send_heartbeat(MonotonicTime now) {
  protocol::Heartbeat message;
  message.uptime_ms = saturate<std::uint32_t>(milliseconds(now - started));
  message.frames_in = status.frames_in;
  message.frames_dropped = status.frames_dropped;
  message.rss_bytes = resident_bytes();
  message.latency_p50_us = status.latency_p50_us;
  message.latency_p99_us = status.latency_p99_us;
  message.latency_max_us = status.latency_max_us;
  message.tiles_known = book.tiles_known();
  message.sensor_count = 1;
  message.sensors[0] = {0, sensor_state(status), status.sensor_age_ms};
  outbox.add(header(now), message);
  bucket.take(1);
  next_heartbeat = now + kHeartbeatPeriod;
}

void Publisher::State::send_announce(MonotonicTime now) {
  base.flags = clock_is_locked() ? protocol::kFlagClockLocked : 0;
  protocol::Announce message;
  message.map_id = base.boot_id;  // every start begins a new map
  message.resolution_m = cell_m;
  message.window = window;
  message.cell_max_age_ms = saturate<std::uint32_t>(settings.cell_max_age_ms);
  message.refresh_ms = refresh_ms();
  message.heartbeat_ms = static_cast<std::uint32_t>(milliseconds(kHeartbeatPeriod));
  message.frame_name = settings.frame_name;
  message.node_name = settings.node_name;
  message.software_version = SCREE_VERSION;
  for (const protocol::Layer layer : kPublishedLayers) {
    const auto& format = protocol::layer_format(layer);
    message.layers.push_back(
        {static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(format.encoding), format.scale, format.offset});
  }
  outbox.add(header(now), message);
  bucket.take(1);
  announced_window = true;
  next_announce = now + kAnnouncePeriod;
}

bool Publisher::State::send_manifests(MonotonicTime now, const std::function<bool()>& room) {
  const TileWindow& tiles = book.window();
  constexpr auto kMaxTiles = static_cast<std::int32_t>(protocol::kMaxManifestTiles);
  const std::int32_t columns = std::min(tiles.columns, kMaxTiles);
  const std::int32_t rows = kMaxTiles / columns;
  protocol::Manifest message;
  int sent = 0;
  for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer) {
    message.layer = static_cast<std::uint8_t>(kPublishedLayers[layer]);
    for (std::int32_t y = 0; y < tiles.rows; y += rows) {
      for (std::int32_t x = 0; x < tiles.columns; x += columns) {
        if (!room()) return false;
        message.tx0 = tiles.min.tx + x;
        message.ty0 = tiles.min.ty + y;
        message.columns = static_cast<std::uint16_t>(std::min(columns, tiles.columns - x));
        message.rows = static_cast<std::uint16_t>(std::min(rows, tiles.rows - y));
        std::size_t i = 0;
        for (std::int32_t r = 0; r < message.rows; ++r)
          for (std::int32_t c = 0; c < message.columns; ++c)
            message.tile_rev[i++] = book.tile_rev(tiles.position({message.tx0 + c, message.ty0 + r}), layer);
        outbox.add(header(now), message);
        bucket.take(1);
        ++sent;
      }
    }
  }
  manifest_wanted = false;
  earliest_manifest = now + from_seconds(sent / (kManifestShare * bucket.per_second()));
  next_manifest = std::max(now + kManifestPeriod, earliest_manifest);
  return true;
}

void Publisher::State::send_unit(MonotonicTime now, TileUnit& unit) {
  Header head = header(now);
  if (!unit.changed) head.flags |= protocol::kFlagRefresh;
  const int blocks = block_count(unit.layer);
  protocol::TileBlock block;
  block.tx = unit.tile.tx;
  block.ty = unit.tile.ty;
  block.tile_rev = unit.tile_rev;
  block.block_age_ms = saturate<std::uint32_t>(milliseconds(now - received));
  for (int b = 0; b < blocks; ++b) {
    copy_block(unit.content, unit.layer, b, block);
    outbox.add(head, block);
  }
  counters.blocks += static_cast<std::uint64_t>(blocks);
  if (!unit.changed) counters.blocks_refreshed += static_cast<std::uint64_t>(blocks);
  bucket.take(blocks);
  book.mark_sent(unit);
}

/// Changed units first come first served; the longest unsent one every refresh_ms / units, so that each is sent at
/// least once per refresh_ms. They take turns when the pacing cannot satisfy both.
void Publisher::State::send_tiles(MonotonicTime now) {
  const Duration interval = refresh_interval();
  next_refresh = std::max(next_refresh, now - Duration(std::chrono::milliseconds(100)));  // no burst after a pause
  while (bucket.has_token() && make_room(2)) {
    TileUnit* const refresh = now >= next_refresh ? book.least_recently_sent() : nullptr;
    TileUnit* const changed = book.next_pending();
    if (refresh == nullptr && changed == nullptr) return;
    const bool take_refresh = changed == nullptr || (refresh != nullptr && refresh_turn);
    refresh_turn = !take_refresh;
    if (take_refresh) next_refresh += interval;
    send_unit(now, take_refresh ? *refresh : *changed);
  }
}

void Publisher::State::send_bye(MonotonicTime now, protocol::ByeReason reason, int copy) {
  Header head = header(now);
  if (copy > 0) head.flags |= protocol::kFlagRepeat;
  outbox.add(head, protocol::Bye{reason});
}

Duration Publisher::State::refresh_interval() const {
  return Duration(std::chrono::milliseconds(settings.refresh_ms)) /
         static_cast<std::int64_t>(std::max<std::size_t>(book.units(), 1));
}

/// What is announced: refresh_ms, or longer where the pacing cannot do it with half of its datagrams.
std::uint32_t Publisher::State::refresh_ms() const {
  const double needed_ms = 2000.0 * static_cast<double>(book.blocks()) / bucket.per_second();
  return saturate<std::uint32_t>(std::max<std::int64_t>(settings.refresh_ms, static_cast<std::int64_t>(needed_ms)));
}

void Publisher::State::send_periodic(MonotonicTime now) {
  if (now >= next_heartbeat && make_room(1)) send_heartbeat(now);
  if (has_map && (now >= next_announce || !announced_window) && make_room(1)) send_announce(now);
}

Duration Publisher::State::tick(MonotonicTime now, const NodeStatus& node_status) {
  status = node_status;
  bucket.refill(now);
  if (started == MonotonicTime{}) started = now;
  if (outbox.flush()) {
    send_periodic(now);
    if (has_map) send_tiles(now);
    if (has_map && now >= manifest_due()) send_manifests(now, [this] { return make_room(1); });
    outbox.flush();
  }
  collect_counters();
  return until_due(now);
}

Duration Publisher::State::until_due(MonotonicTime now) const {
  constexpr Duration kRetry = std::chrono::milliseconds(1);
  if (!outbox.empty()) return kRetry;
  MonotonicTime due = next_heartbeat;
  if (has_map) {
    due = std::min({due, next_announce, manifest_due()});
    // a few refreshes at a time, so that a quiet map does not wake the thread for each
    const Duration bundle = std::min<Duration>(8 * refresh_interval(), std::chrono::milliseconds(20));
    due = std::min(due, next_refresh + bundle);
    if (book.has_pending()) due = now;
    if (due <= now + bundle) due = std::max(due, now + bucket.until_worthwhile());
    due = std::min(due, next_heartbeat);
  }
  return std::max<Duration>(due - now, Duration{0});
}

void Publisher::State::collect_counters() {
  const Outbox::Counters& sent = outbox.counters();
  counters.datagrams = sent.datagrams;
  counters.bytes = sent.bytes;
  counters.send_errors = sent.send_errors;
  counters.send_blocked = sent.send_blocked;
  counters.cells_saturated = book.quantisation().saturated;
}

}  // namespace scree::node
