// When what is sent to one destination. How a message is made of the map: map_stream_messages.cpp.

#include "node/map_stream.hpp"

#include <algorithm>

#include "node/saturate.hpp"

namespace scree::node {

MapStream::MapStream(std::shared_ptr<UdpSocket> socket, std::optional<Endpoint> to, const StreamWish& wish,
                     std::uint64_t first_seq, const PublishedMap& map)
    : wish_(wish),
      outbox_(std::move(socket), to, first_seq),
      bucket_(wish.datagrams_per_s),
      next_pose_(map.poses.count()) {
  select_units(map);
}

void MapStream::change(const StreamWish& wish, const PublishedMap& map) {
  if (wish.datagrams_per_s != wish_.datagrams_per_s) bucket_ = TokenBucket(wish.datagrams_per_s);
  if (wish.layer_mask != wish_.layer_mask) announced_window_ = false;  // it names other layers
  const bool same_units = wish.layer_mask == wish_.layer_mask && wish.region == wish_.region;
  wish_ = wish;
  if (!same_units) select_units(map);
}

void MapStream::select_units(const PublishedMap& map) {
  if (!map.has_map) return;
  manifest_wanted_ = true;
  queue_.reserve(map.book.handles());
  const auto tiles = static_cast<std::size_t>(map.book.window().tiles());
  for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer) {
    for (std::size_t position = 0; position < tiles; ++position) {
      const UnitHandle handle = map.book.at(position, layer);
      const TileUnit& unit = map.book.unit(handle);
      if (!wants(unit))
        queue_.remove(handle);
      else if (!queue_.contains(handle))
        queue_.change(handle, block_count(unit.layer), map.generation);
    }
  }
}

void MapStream::note_map(const PublishedMap& map, bool window_moved) {
  if (window_moved) announced_window_ = false;
  manifest_wanted_ = true;
  queue_.reserve(map.book.handles());
  for (const UnitHandle handle : map.book.removed()) queue_.remove(handle);
  for (const UnitHandle handle : map.book.changed()) {
    const TileUnit& unit = map.book.unit(handle);
    if (wants(unit)) queue_.change(handle, block_count(unit.layer), map.generation);
  }
}

bool MapStream::resend(UnitHandle unit, const PublishedMap& map) {
  return queue_.request(unit, map.generation);
}

std::uint64_t MapStream::generation_out(const PublishedMap& map) const {
  if (!outbox_.empty()) return 0;
  const auto since = queue_.pending_since();
  return since ? *since - 1 : map.generation;
}

/// Changed and requested units first come first served; copies when they are due; the longest unsent unit every
/// refresh_ms / units, so that each is sent at least once per refresh_ms. Changed ones and refreshes take turns when
/// the pacing cannot satisfy both.
void MapStream::send_tiles(MonotonicTime now, PublishedMap& map) {
  const Duration interval = refresh_interval(map);
  next_refresh_ = std::max(next_refresh_, now - Duration(std::chrono::milliseconds(100)));  // no burst after a pause
  while (bucket_.has_token() && make_room(2, map)) {
    if (send_repeat(now, map)) continue;  // few, and of no use when they come late
    const auto refresh = now >= next_refresh_ ? queue_.least_recently_sent() : std::nullopt;
    const auto pending = queue_.next_pending();
    if (!refresh && !pending) return;
    const bool requested = pending && queue_.requested(*pending);
    const bool take_refresh = !pending || (refresh && refresh_turn_ && !requested);
    refresh_turn_ = !take_refresh;
    if (take_refresh) next_refresh_ += interval;
    const UnitHandle unit = take_refresh ? *refresh : *pending;
    const bool changed = queue_.changed(unit);
    send_unit(now, map, unit, changed ? std::uint8_t{0} : std::uint8_t{protocol::kFlagRefresh});
    queue_.mark_sent(unit, changed ? wish_.repeats : 0, now + kRepeatDistance);
  }
}

bool MapStream::send_repeat(MonotonicTime now, PublishedMap& map) {
  const auto unit = queue_.next_repeat(now);
  if (!unit) return false;
  send_unit(now, map, *unit, protocol::kFlagRepeat);
  queue_.mark_repeated(*unit, now + kRepeatDistance);
  return true;
}

Duration MapStream::refresh_interval(const PublishedMap& map) const {
  return Duration(std::chrono::milliseconds(map.settings.refresh_ms)) /
         static_cast<std::int64_t>(std::max<std::size_t>(queue_.units(), 1));
}

/// What is announced: refresh_ms, or longer where the pacing cannot do it with half of its datagrams.
std::uint32_t MapStream::refresh_ms(const PublishedMap& map) const {
  const double needed_ms = 2000.0 * static_cast<double>(queue_.blocks()) / bucket_.per_second();
  return saturate<std::uint32_t>(std::max<std::int64_t>(map.settings.refresh_ms, static_cast<std::int64_t>(needed_ms)));
}

void MapStream::send_periodic(MonotonicTime now, PublishedMap& map) {
  if (now >= next_heartbeat_ && make_room(1, map)) send_heartbeat(now, map);
  if (map.has_map && (now >= next_announce_ || !announced_window_) && make_room(1, map)) send_announce(now, map);
}

Duration MapStream::tick(MonotonicTime now, PublishedMap& map) {
  bucket_.refill(now);
  if (flush(map)) {
    send_periodic(now, map);
    send_poses(now, map);
    if (map.has_map) send_tiles(now, map);
    if (map.has_map && now >= manifest_due()) send_manifests(now, map, [&] { return make_room(1, map); });
    flush(map);
  }
  return until_due(now, map);
}

Duration MapStream::until_due(MonotonicTime now, const PublishedMap& map) const {
  constexpr Duration kRetry = std::chrono::milliseconds(1);
  if (!outbox_.empty()) return kRetry;
  MonotonicTime due = next_heartbeat_;
  if (map.has_map) {
    due = std::min({due, next_announce_, manifest_due()});
    // a few refreshes at a time, so that a quiet map does not wake the thread for each
    const Duration bundle = std::min<Duration>(8 * refresh_interval(map), std::chrono::milliseconds(20));
    if (queue_.units() > 0) due = std::min(due, next_refresh_ + bundle);
    if (const auto repeat = queue_.repeat_due()) due = std::min(due, *repeat);
    if (queue_.has_pending() || next_pose_ < map.poses.count()) due = now;
    if (due <= now + bundle) due = std::max(due, now + bucket_.until_worthwhile());
    due = std::min(due, next_heartbeat_);
  }
  return std::max<Duration>(due - now, Duration{0});
}

void MapStream::send_all_again(const PublishedMap& map) {
  queue_.mark_all_pending(map.generation);
  next_announce_ = {};  // a receiver must know the window before the last tiles come
}

void MapStream::send_pending(MonotonicTime now, PublishedMap& map) {
  bucket_.refill(now);
  if (!flush(map)) return;
  send_periodic(now, map);
  while (queue_.has_pending() && bucket_.has_token() && make_room(2, map)) {
    const UnitHandle unit = *queue_.next_pending();
    send_unit(now, map, unit, queue_.changed(unit) ? std::uint8_t{0} : std::uint8_t{protocol::kFlagRefresh});
    queue_.mark_sent(unit, 0, now);
  }
  flush(map);
}

}  // namespace scree::node
