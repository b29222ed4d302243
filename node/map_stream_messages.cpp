// The messages of a destination, made of the map.

#include <algorithm>

#include "node/map_stream.hpp"
#include "node/saturate.hpp"

namespace scree::node {

void MapStream::send_heartbeat(MonotonicTime now, PublishedMap& map) {
  add(map.header(now), map.heartbeat(now), map);
  next_heartbeat_ = now + kHeartbeatPeriod;
}

void MapStream::send_announce(MonotonicTime now, PublishedMap& map) {
  auto message = map.announce(wish_.layer_mask, refresh_ms(map));
  message.heartbeat_ms = static_cast<std::uint32_t>(to_milliseconds(kHeartbeatPeriod));
  add(map.header(now), message, map);
  if (!announced_window_) announce_copies_ = kAnnounceCopies;
  announced_window_ = true;
  next_announce_ = now + (announce_copies_ > 0 ? kAnnounceCopyPeriod : kAnnouncePeriod);
  announce_copies_ = std::max(0, announce_copies_ - 1);
}

void MapStream::send_poses(MonotonicTime now, PublishedMap& map) {
  if (next_pose_ < map.poses.oldest()) {
    map.counters.poses_superseded += map.poses.oldest() - next_pose_;
    next_pose_ = map.poses.oldest();
  }
  for (; next_pose_ < map.poses.count() && bucket_.has_token() && make_room(1, map); ++next_pose_) {
    const PoseLog::Entry& entry = map.poses[next_pose_];
    protocol::PoseMessage message = entry.message;
    message.age_us =
        saturate<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(now - entry.delivered).count());
    add(map.header(now), message, map);
    ++map.counters.poses;
  }
}

TileWindow MapStream::wanted_window(const PublishedMap& map) const {
  const TileWindow& all = map.book.window();
  TileWindow out;
  out.min = {std::max(all.min.tx, wish_.region.tx_min), std::max(all.min.ty, wish_.region.ty_min)};
  out.columns = std::max(0, std::min(all.min.tx + all.columns - 1, wish_.region.tx_max) - out.min.tx + 1);
  out.rows = std::max(0, std::min(all.min.ty + all.rows - 1, wish_.region.ty_max) - out.min.ty + 1);
  return out;
}

bool MapStream::send_manifests(MonotonicTime now, PublishedMap& map, const std::function<bool()>& room) {
  const TileWindow tiles = wanted_window(map);
  constexpr auto kMaxTiles = static_cast<std::int32_t>(protocol::kMaxManifestTiles);
  const std::int32_t columns = std::clamp(tiles.columns, 1, kMaxTiles);
  const std::int32_t rows = kMaxTiles / columns;
  protocol::Manifest message;
  int sent = 0;
  for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer) {
    if ((wish_.layer_mask & layer_bit(kPublishedLayers[layer])) == 0) continue;
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
            message.tile_rev[i++] =
                map.book.tile_rev(map.book.window().position({message.tx0 + c, message.ty0 + r}), layer);
        add(map.header(now), message, map);
        ++sent;
      }
    }
  }
  manifest_wanted_ = false;
  earliest_manifest_ = now + from_seconds(sent / (kManifestShare * bucket_.per_second()));
  next_manifest_ = std::max(now + kManifestPeriod, earliest_manifest_);
  return true;
}

void MapStream::send_unit(MonotonicTime now, PublishedMap& map, UnitHandle handle, std::uint8_t flags) {
  const TileUnit& unit = map.book.unit(handle);
  protocol::Header head = map.header(now);
  head.flags |= flags;
  const int blocks = block_count(unit.layer);
  protocol::TileBlock block;
  block.tx = unit.tile.tx;
  block.ty = unit.tile.ty;
  block.tile_rev = unit.tile_rev;
  block.block_age_ms = saturate<std::uint32_t>(to_milliseconds(now - map.received));
  for (int b = 0; b < blocks; ++b) {
    copy_block(unit.content, unit.layer, b, block);
    add(head, block, map);
  }
  const auto count = static_cast<std::uint64_t>(blocks);
  map.counters.blocks += count;
  if (flags & protocol::kFlagRefresh) map.counters.blocks_refreshed += count;
  if (flags & protocol::kFlagRepeat) map.counters.blocks_repeated += count;
}

void MapStream::send_bye(MonotonicTime now, PublishedMap& map, protocol::ByeReason reason, int copy) {
  protocol::Header head = map.header(now);
  if (copy > 0) head.flags |= protocol::kFlagRepeat;
  add(head, protocol::Bye{reason}, map);
}

}  // namespace scree::node
