#include <algorithm>
#include <bitset>
#include <cassert>
#include <cmath>
#include <limits>

#include "node/protocol_bytes.hpp"
#include "node/protocol_messages.hpp"
#include "node/tile_window.hpp"

namespace scree::node::protocol {
namespace {

constexpr std::size_t kMaxLayers = 64;

void put_anchor(ByteWriter& writer, const std::optional<GeoAnchor>& anchor) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const GeoAnchor value = anchor.value_or(GeoAnchor{nan, nan, nan, nan});
  writer.f64(value.latitude_deg);
  writer.f64(value.longitude_deg);
  writer.f64(value.altitude_m);
  writer.f64(value.heading_rad);
}

/// All NaN: no anchor. Otherwise all must be numbers, and a place on the Earth.
bool get_anchor(ByteReader& reader, std::optional<GeoAnchor>& out) {
  GeoAnchor value;
  value.latitude_deg = reader.f64();
  value.longitude_deg = reader.f64();
  value.altitude_m = reader.f64();
  value.heading_rad = reader.f64();
  out.reset();
  if (std::isnan(value.latitude_deg) && std::isnan(value.longitude_deg) && std::isnan(value.altitude_m) &&
      std::isnan(value.heading_rad))
    return true;
  out = value;
  return std::abs(value.latitude_deg) <= 90.0 && std::abs(value.longitude_deg) <= 180.0 &&
         std::isfinite(value.altitude_m) && std::isfinite(value.heading_rad);
}

void put_window(ByteWriter& writer, const LatticeWindow& window) {
  const TileWindow tiles = tiles_touched(window);
  writer.put(tiles.min.tx);
  writer.put(tiles.min.ty);
  writer.put(tiles.min.tx + tiles.columns - 1);
  writer.put(tiles.min.ty + tiles.rows - 1);
  writer.put(window.min.x);
  writer.put(window.min.y);
  writer.put(static_cast<std::uint32_t>(window.columns));
  writer.put(static_cast<std::uint32_t>(window.rows));
}

/// Not empty, ends within i32, not too many tiles, and the tile window is the one that follows from the cells.
bool get_window(ByteReader& reader, LatticeWindow& window) {
  const auto tx_min = reader.get<std::int32_t>();
  const auto ty_min = reader.get<std::int32_t>();
  const auto tx_max = reader.get<std::int32_t>();
  const auto ty_max = reader.get<std::int32_t>();
  window.min.x = reader.get<std::int32_t>();
  window.min.y = reader.get<std::int32_t>();
  const auto columns = reader.get<std::uint32_t>();
  const auto rows = reader.get<std::uint32_t>();
  constexpr std::int64_t kMaxSide = kMaxWindowTiles * kTileCells;
  constexpr std::int64_t kEnd = std::int64_t{1} << 31;
  if (columns == 0 || rows == 0 || columns > kMaxSide || rows > kMaxSide) return false;
  if (window.min.x + std::int64_t{columns} > kEnd || window.min.y + std::int64_t{rows} > kEnd) return false;
  window.columns = static_cast<int>(columns);
  window.rows = static_cast<int>(rows);
  const TileWindow tiles = tiles_touched(window);
  return tiles.tiles() <= kMaxWindowTiles && tiles.min == TileIndex{tx_min, ty_min} &&
         std::int64_t{tx_max} - tx_min == tiles.columns - 1 && std::int64_t{ty_max} - ty_min == tiles.rows - 1;
}

bool get_name(ByteReader& reader, std::string& out) {
  const auto bytes = reader.bytes(kNameBytes);
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  out.assign(bytes.begin(), end);
  return end != bytes.end() && valid_name(out);
}

bool get_layers(ByteReader& reader, std::size_t count, std::vector<AnnouncedLayer>& out) {
  std::bitset<256> seen;
  out.clear();
  for (std::size_t i = 0; i < count; ++i) {
    AnnouncedLayer layer;
    layer.layer = reader.get<std::uint8_t>();
    layer.encoding = reader.get<std::uint8_t>();
    reader.skip(2);
    layer.scale = reader.f32();
    layer.offset = reader.f32();
    if (seen.test(layer.layer) || !std::isfinite(layer.scale) || !(layer.scale > 0.0f) || !std::isfinite(layer.offset))
      return false;
    seen.set(layer.layer);
    out.push_back(layer);
  }
  return true;
}

bool valid_times(const Announce& message) {
  return message.stale_ms > 0 && message.lost_ms >= message.stale_ms && message.refresh_ms > 0 &&
         message.heartbeat_ms > 0;
}

}  // namespace

bool valid_name(std::string_view name) {
  return !name.empty() && name.size() < kNameBytes && std::none_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

void encode(Header header, const Announce& message, Datagram& out, const Key* key) {
  header.type = MessageType::announce;
  assert(message.layers.size() <= kMaxLayers);
  ByteWriter writer(out.body());
  writer.put(message.map_id);
  writer.f64(message.resolution_m);
  put_anchor(writer, message.anchor);
  put_window(writer, message.window);
  writer.put(message.stale_ms);
  writer.put(message.lost_ms);
  writer.put(message.cell_max_age_ms);
  writer.put(message.refresh_ms);
  writer.put(message.heartbeat_ms);
  writer.put(static_cast<std::uint8_t>(kTileLog2));
  writer.put(static_cast<std::uint8_t>(message.layers.size()));
  writer.zeros(2);
  writer.text(message.frame_name, kNameBytes);
  writer.text(message.node_name, kNameBytes);
  writer.text(message.software_version, kNameBytes);
  for (const AnnouncedLayer& layer : message.layers) {
    writer.put(layer.layer);
    writer.put(layer.encoding);
    writer.zeros(2);
    writer.f32(layer.scale);
    writer.f32(layer.offset);
  }
  assert(writer.ok());
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Announce& out) {
  if (opened.body.size() < kAnnounceBytes) return Reject::body_length;
  ByteReader reader(opened.body);
  out.map_id = reader.get<std::uint64_t>();
  out.resolution_m = reader.f64();
  if (!std::isfinite(out.resolution_m) || !(out.resolution_m > 0.0)) return Reject::body_value;
  if (!get_anchor(reader, out.anchor) || !get_window(reader, out.window)) return Reject::body_value;
  out.stale_ms = reader.get<std::uint32_t>();
  out.lost_ms = reader.get<std::uint32_t>();
  out.cell_max_age_ms = reader.get<std::uint32_t>();
  out.refresh_ms = reader.get<std::uint32_t>();
  out.heartbeat_ms = reader.get<std::uint32_t>();
  const int tile_log2 = reader.get<std::uint8_t>();
  const std::size_t layers = reader.get<std::uint8_t>();
  reader.skip(2);
  if (!valid_times(out) || tile_log2 != kTileLog2 || layers > kMaxLayers) return Reject::body_value;
  if (!body_ends_at(opened, kAnnounceBytes + layers * kAnnouncedLayerBytes)) return Reject::body_length;
  if (!get_name(reader, out.frame_name) || !get_name(reader, out.node_name) || !get_name(reader, out.software_version))
    return Reject::body_value;
  return get_layers(reader, layers, out.layers) ? Reject::none : Reject::body_value;
}

}  // namespace scree::node::protocol
