#include "node/protocol_requests.hpp"

#include <cassert>

#include "node/protocol_bytes.hpp"
#include "node/protocol_messages.hpp"

namespace scree::node::protocol {
namespace {

bool valid_index(std::int32_t index) {
  return index >= -kTileIndexLimit && index < kTileIndexLimit;
}

bool valid_region(const TileRegion& region) {
  return valid_index(region.tx_min) && valid_index(region.ty_min) && valid_index(region.tx_max) &&
         valid_index(region.ty_max) && region.tx_min <= region.tx_max && region.ty_min <= region.ty_max;
}

bool has_body(const Opened& opened, std::size_t bytes) {
  return opened.body.size() >= bytes && body_ends_at(opened, bytes);
}

}  // namespace

void encode(Header header, const Subscribe& message, Datagram& out, const Key* key) {
  assert(valid_region(message.region) && message.repeats <= kMaxRepeats);
  header.type = MessageType::subscribe;
  ByteWriter writer(out.body());
  writer.put(message.cookie);
  writer.put(message.layer_mask);
  writer.put(message.region.tx_min);
  writer.put(message.region.ty_min);
  writer.put(message.region.tx_max);
  writer.put(message.region.ty_max);
  writer.put(message.datagrams_per_s);
  writer.put(message.repeats);
  writer.zeros(3);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Subscribe& out) {
  if (!has_body(opened, kSubscribeBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  out.cookie = reader.get<std::uint64_t>();
  out.layer_mask = reader.get<std::uint64_t>();
  out.region.tx_min = reader.get<std::int32_t>();
  out.region.ty_min = reader.get<std::int32_t>();
  out.region.tx_max = reader.get<std::int32_t>();
  out.region.ty_max = reader.get<std::int32_t>();
  out.datagrams_per_s = reader.get<std::uint32_t>();
  out.repeats = reader.get<std::uint8_t>();
  return valid_region(out.region) && out.repeats <= kMaxRepeats ? Reject::none : Reject::body_value;
}

void encode(Header header, const Cookie& message, Datagram& out, const Key* key) {
  assert(message.cookie != 0 && message.lease_ms > 0);
  header.type = MessageType::cookie;
  ByteWriter writer(out.body());
  writer.put(message.cookie);
  writer.put(message.lease_ms);
  writer.zeros(4);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Cookie& out) {
  if (!has_body(opened, kCookieBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  out.cookie = reader.get<std::uint64_t>();
  out.lease_ms = reader.get<std::uint32_t>();
  return out.cookie != 0 && out.lease_ms > 0 ? Reject::none : Reject::body_value;
}

void encode(Header header, const Nack& message, Datagram& out, const Key* key) {
  assert(message.count >= 1 && message.count <= kMaxNackTiles);
  header.type = MessageType::nack;
  ByteWriter writer(out.body());
  writer.put(message.cookie);
  writer.put(static_cast<std::uint8_t>(message.layer));
  writer.put(message.count);
  writer.zeros(6);
  for (std::size_t i = 0; i < message.count; ++i) {
    writer.put(message.tiles[i].tx);
    writer.put(message.tiles[i].ty);
  }
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Nack& out) {
  if (opened.body.size() < kNackBytes) return Reject::body_length;
  ByteReader reader(opened.body);
  out.cookie = reader.get<std::uint64_t>();
  const auto layer = layer_from_wire(reader.get<std::uint8_t>());
  out.count = reader.get<std::uint8_t>();
  reader.skip(6);
  if (out.count < 1 || out.count > kMaxNackTiles) return Reject::body_value;
  if (!layer) return Reject::layer;
  out.layer = *layer;
  if (!body_ends_at(opened, kNackBytes + out.count * kNackTileBytes)) return Reject::body_length;
  for (std::size_t i = 0; i < out.count; ++i) {
    out.tiles[i].tx = reader.get<std::int32_t>();
    out.tiles[i].ty = reader.get<std::int32_t>();
    if (!valid_index(out.tiles[i].tx) || !valid_index(out.tiles[i].ty)) return Reject::body_value;
  }
  return Reject::none;
}

void encode(Header header, const Ping& message, Datagram& out, const Key* key) {
  header.type = MessageType::ping;
  ByteWriter writer(out.body());
  writer.put(message.nonce);
  writer.put(message.t_request_ns);
  writer.zeros(16);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Ping& out) {
  if (!has_body(opened, kPingBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  out.nonce = reader.get<std::uint64_t>();
  out.t_request_ns = reader.get<std::int64_t>();
  return Reject::none;
}

void encode(Header header, const Pong& message, Datagram& out, const Key* key) {
  header.type = MessageType::pong;
  ByteWriter writer(out.body());
  writer.put(message.nonce);
  writer.put(message.t_request_ns);
  writer.put(message.t_receive_ns);
  writer.put(message.t_answer_ns);
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, Pong& out) {
  if (!has_body(opened, kPingBytes)) return Reject::body_length;
  ByteReader reader(opened.body);
  out.nonce = reader.get<std::uint64_t>();
  out.t_request_ns = reader.get<std::int64_t>();
  out.t_receive_ns = reader.get<std::int64_t>();
  out.t_answer_ns = reader.get<std::int64_t>();
  return Reject::none;
}

}  // namespace scree::node::protocol
