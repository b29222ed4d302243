#include "node/published_map.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <sys/timex.h>
#include <unistd.h>

#include "node/saturate.hpp"

namespace scree::node {
namespace {

constexpr Duration kLookPeriod = std::chrono::milliseconds(100);

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

std::uint32_t to_us(Duration duration) {
  return saturate<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(duration).count());
}

}  // namespace

void PublishedMap::take(const mapping::MapSnapshot& snapshot) {
  book.update(snapshot);
  has_map = true;
  window = snapshot.window;
  revision = snapshot.revision;
  data_time = snapshot.data_time;
  received = snapshot.received;
  ++generation;
}

void PublishedMap::look_at_system(MonotonicTime now) {
  if (started == MonotonicTime{}) started = now;
  if (now < next_look_) return;
  next_look_ = now + kLookPeriod;
  rss_bytes_ = resident_bytes();
  base.flags = clock_is_locked() ? protocol::kFlagClockLocked : 0;
}

protocol::Header PublishedMap::header(MonotonicTime now) const {
  protocol::Header out = base;
  out.health = status.health;
  if (status.origin) out.origin = *status.origin;
  out.map_rev = revision;
  out.age_us = std::numeric_limits<std::uint32_t>::max();
  if (has_map) {
    out.t_data_ns = data_time.time_since_epoch().count();
    out.age_us = to_us(now - received);
  }
  return out;
}

protocol::Heartbeat PublishedMap::heartbeat(MonotonicTime now) const {
  protocol::Heartbeat message;
  message.uptime_ms = saturate<std::uint32_t>(to_milliseconds(now - started));
  message.frames_in = status.frames_in;
  message.frames_dropped = status.frames_dropped;
  message.rss_bytes = rss_bytes_;
  message.latency_p50_us = to_us(latency.percentile(0.5));
  message.latency_p99_us = to_us(latency.percentile(0.99));
  message.latency_max_us = to_us(latency.max());
  message.tiles_known = book.tiles_known();
  message.sensor_count = status.sensor_count;
  message.sensors = status.sensors;
  return message;
}

protocol::Announce PublishedMap::announce(std::uint64_t layer_mask, std::uint32_t refresh_ms) const {
  protocol::Announce message;
  message.map_id = base.boot_id;  // every start begins a new map
  message.resolution_m = cell_m;
  message.window = window;
  message.cell_max_age_ms = saturate<std::uint32_t>(settings.cell_max_age_ms);
  message.refresh_ms = refresh_ms;
  message.frame_name = settings.frame_name;
  message.node_name = settings.node_name;
  message.software_version = SCREE_VERSION;
  for (const protocol::Layer layer : kPublishedLayers) {
    if ((layer_mask & layer_bit(layer)) == 0) continue;
    const auto& format = protocol::layer_format(layer);
    message.layers.push_back(
        {static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(format.encoding), format.scale, format.offset});
  }
  return message;
}

}  // namespace scree::node
