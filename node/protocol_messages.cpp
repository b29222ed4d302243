#include "node/protocol_messages.hpp"

#include <cassert>

#include "node/protocol_bytes.hpp"
#include "node/protocol_tile.hpp"

namespace scree::node::protocol {
namespace {

void finish(Header& header, const ByteWriter& writer, Datagram& out, const Key* key) {
  assert(writer.ok());
  seal(header, writer.size(), out, key);
}

bool valid_rectangle(const Manifest& manifest) {
  const auto fits = [](std::int32_t first, int count) {
    return first >= -kTileIndexLimit && std::int64_t{first} + count <= kTileIndexLimit;
  };
  return manifest.columns > 0 && manifest.rows > 0 &&
         std::size_t{manifest.columns} * manifest.rows <= kMaxManifestTiles && fits(manifest.tx0, manifest.columns) &&
         fits(manifest.ty0, manifest.rows);
}

}  // namespace

bool body_ends_at(const Opened& opened, std::size_t bytes) {
  return opened.header.ver_minor == kVersionMinor ? opened.body.size() == bytes : opened.body.size() >= bytes;
}

void encode(Header header, const Manifest& message, Datagram& out, const Key* key) {
  assert(valid_rectangle(message));
  header.type = MessageType::manifest;
  ByteWriter writer(out.body());
  writer.put(message.tx0);
  writer.put(message.ty0);
  writer.put(message.columns);
  writer.put(message.rows);
  writer.put(message.layer);
  writer.put(static_cast<std::uint8_t>(kTileLog2));
  writer.zeros(2);
  const std::size_t tiles = std::size_t{message.columns} * message.rows;
  for (std::size_t i = 0; i < tiles; ++i) writer.put(message.tile_rev[i]);
  finish(header, writer, out, key);
}

Reject decode(const Opened& opened, Manifest& out) {
  if (opened.body.size() < kManifestBytes) return Reject::body_length;
  ByteReader reader(opened.body);
  out.tx0 = reader.get<std::int32_t>();
  out.ty0 = reader.get<std::int32_t>();
  out.columns = reader.get<std::uint16_t>();
  out.rows = reader.get<std::uint16_t>();
  out.layer = reader.get<std::uint8_t>();
  const int tile_log2 = reader.get<std::uint8_t>();
  reader.skip(2);
  if (!valid_rectangle(out) || tile_log2 != kTileLog2) return Reject::body_value;
  if (!layer_from_wire(out.layer)) return Reject::layer;
  const std::size_t tiles = std::size_t{out.columns} * out.rows;
  if (!body_ends_at(opened, kManifestBytes + 4 * tiles)) return Reject::body_length;
  for (std::size_t i = 0; i < tiles; ++i) out.tile_rev[i] = reader.get<std::uint32_t>();
  return Reject::none;
}

void encode(Header header, const Heartbeat& message, Datagram& out, const Key* key) {
  assert(message.sensor_count <= kMaxSensors);
  header.type = MessageType::heartbeat;
  ByteWriter writer(out.body());
  writer.put(message.uptime_ms);
  writer.put(message.frames_in);
  writer.put(message.frames_dropped);
  writer.put(message.rss_bytes);
  writer.put(message.latency_p50_us);
  writer.put(message.latency_p99_us);
  writer.put(message.latency_max_us);
  writer.put(message.tiles_known);
  writer.put(message.sensor_count);
  writer.zeros(7);
  for (std::size_t i = 0; i < message.sensor_count; ++i) {
    writer.put(message.sensors[i].sensor);
    writer.put(static_cast<std::uint8_t>(message.sensors[i].state));
    writer.zeros(2);
    writer.put(message.sensors[i].age_ms);
  }
  finish(header, writer, out, key);
}

Reject decode(const Opened& opened, Heartbeat& out) {
  if (opened.body.size() < kHeartbeatBytes) return Reject::body_length;
  ByteReader reader(opened.body);
  out.uptime_ms = reader.get<std::uint64_t>();
  out.frames_in = reader.get<std::uint64_t>();
  out.frames_dropped = reader.get<std::uint64_t>();
  out.rss_bytes = reader.get<std::uint64_t>();
  out.latency_p50_us = reader.get<std::uint32_t>();
  out.latency_p99_us = reader.get<std::uint32_t>();
  out.latency_max_us = reader.get<std::uint32_t>();
  out.tiles_known = reader.get<std::uint32_t>();
  out.sensor_count = reader.get<std::uint8_t>();
  reader.skip(7);
  if (out.sensor_count > kMaxSensors) return Reject::body_value;
  if (!body_ends_at(opened, kHeartbeatBytes + out.sensor_count * kSensorBytes)) return Reject::body_length;
  out.sensors = {};
  for (std::size_t i = 0; i < out.sensor_count; ++i) {
    out.sensors[i].sensor = reader.get<std::uint8_t>();
    const auto state = reader.get<std::uint8_t>();
    reader.skip(2);
    out.sensors[i].age_ms = reader.get<std::uint32_t>();
    if (state > static_cast<std::uint8_t>(SensorState::lost)) return Reject::body_value;
    out.sensors[i].state = static_cast<SensorState>(state);
  }
  return Reject::none;
}

void encode(Header header, const Bye& message, Datagram& out, const Key* key) {
  header.type = MessageType::bye;
  ByteWriter writer(out.body());
  writer.put(static_cast<std::uint8_t>(message.reason));
  writer.zeros(kByeBytes - 1);
  finish(header, writer, out, key);
}

Reject decode(const Opened& opened, Bye& out) {
  if (opened.body.size() < kByeBytes || !body_ends_at(opened, kByeBytes)) return Reject::body_length;
  out.reason = static_cast<ByeReason>(opened.body[0]);
  return Reject::none;
}

}  // namespace scree::node::protocol
