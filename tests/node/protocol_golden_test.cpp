// The vectors in client/golden were written by a Python program that shares no code with the node. Each is decoded
// and compared field by field, then encoded from the same fields and compared byte for byte.

#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "node/protocol.hpp"
#include "tests/node/golden.hpp"

namespace scree::node::protocol {
namespace {

using test::golden;

Header golden_header(MessageType type) {
  Header header;
  header.type = type;
  header.stream_id = 7;
  header.boot_id = 0x0123456789ABCDEF;
  header.seq = 1;
  header.t_data_ns = 1700000000123456789;
  header.age_us = 12345;
  header.map_rev = 42;
  header.health = kHealthSensorStale | kHealthPoseStale;
  header.cost_profile = 3;
  header.config_hash = 0xDEADBEEF;
  return header;
}

template <class Message>
void expect_encodes_to(const Header& header, const Message& message, const std::vector<std::uint8_t>& expected) {
  Datagram datagram;
  encode(header, message, datagram);
  EXPECT_EQ(std::vector<std::uint8_t>(datagram.view().begin(), datagram.view().end()), expected);
}

template <class Message>
Message decoded(const std::vector<std::uint8_t>& bytes, const Header& expected) {
  Message message;
  Opened opened;
  EXPECT_FALSE(bytes.empty());
  EXPECT_EQ(open_datagram(bytes, opened), Reject::none);
  EXPECT_EQ(opened.header, expected);
  EXPECT_EQ(decode(opened, message), Reject::none);
  return message;
}

Announce golden_announce() {
  Announce announce;
  announce.map_id = 9;
  announce.resolution_m = 0.1;
  announce.anchor = GeoAnchor{49.5, 11.25, 310.0, 0.5};
  announce.window = {{-100, 33}, 150, 200};
  announce.frame_name = "map";
  announce.node_name = "rover";
  announce.software_version = "0.1.0";
  announce.layers = {{0, 0, 1.0f, 0.0f},
                     {1, 1, 0x1p-12f, 0.0f},
                     {2, 0, 1.0f / 254, 2.0f},
                     {8, 0, 0x1p-14f, 0.0f},
                     {10, 0, 1.0f, 0.0f}};
  return announce;
}

TEST(GoldenVectors, Announce) {
  Header header = golden_header(MessageType::announce);
  header.origin = drivers::Origin::sim;
  EXPECT_EQ(decoded<Announce>(golden("announce"), header), golden_announce());
  expect_encodes_to(header, golden_announce(), golden("announce"));
}

TEST(GoldenVectors, AnnounceWithoutAnchor) {
  const Header header = golden_header(MessageType::announce);
  Announce announce;
  announce.map_id = 9;
  announce.resolution_m = 0.05;
  announce.window = {{0, 0}, 1, 1};
  announce.stale_ms = 200;
  announce.lost_ms = 500;
  announce.cell_max_age_ms = 2000;
  announce.refresh_ms = 250;
  announce.frame_name = "odom";
  announce.node_name = "n";
  announce.software_version = "9";
  EXPECT_EQ(decoded<Announce>(golden("announce_no_anchor"), header), announce);
  expect_encodes_to(header, announce, golden("announce_no_anchor"));
}

struct TileVector {
  const char* name;
  Layer layer;
  int row0;
  float scale;
  float offset;
  std::function<int(int)> raw;
  std::uint8_t flags = 0;
  std::uint64_t seq = 1;
};

int elevation_raw(int i, int row0) {
  return i % 11 == 0 ? -32768 : (i * 127 + row0 * 1000) % 65535 - 32767;
}

const std::vector<TileVector> kTiles = {
    {"tile_cost_raw", Layer::cost, 0, 1.0f, 0.0f, [](int i) { return (i * 7 + 3) % 256; }},
    {"tile_cost_constant", Layer::cost, 0, 1.0f, 0.0f, [](int) { return 255; }, kFlagRefresh},
    {"tile_cost_run_length", Layer::cost, 0, 1.0f, 0.0f,
     [](int i) {
       return i < 300 ? 255 : i < 700 ? 0 : i == 700 ? 254 : 17;
     }},
    {"tile_elevation_lower", Layer::elevation, 0, 0x1p-12f, -3.0f, [](int i) { return elevation_raw(i, 0); }, 0, 2},
    {"tile_elevation_upper", Layer::elevation, 16, 0x1p-12f, -3.0f, [](int i) { return elevation_raw(i, 16); }, 0, 18},
    {"tile_elevation_constant", Layer::elevation, 16, 0x1p-12f, 0.0f, [](int) { return -1234; }},
    {"tile_dimension", Layer::dimension, 0, 1.0f / 254, 2.0f, [](int i) { return i * 13 % 256; }},
    {"tile_amplitude", Layer::amplitude, 0, 0x1p-10f, 0.0f, [](int i) { return i < 512 ? 100 : 255; }},
    {"tile_cell_state", Layer::cell_state, 0, 1.0f, 0.0f, [](int i) { return i < 512 ? 4 : 3; }},
};

TEST(GoldenVectors, Tiles) {
  for (const TileVector& vector : kTiles) {
    SCOPED_TRACE(vector.name);
    Header header = golden_header(MessageType::tile);
    header.flags = vector.flags;
    header.seq = vector.seq;
    TileBlock block;
    block.tx = -4;
    block.ty = 5;
    block.tile_rev = 41;
    block.layer = vector.layer;
    block.row0 = static_cast<std::uint8_t>(vector.row0);
    block.rows = vector.layer == Layer::elevation ? 16 : 32;
    block.scale = vector.scale;
    block.offset = vector.offset;
    block.block_age_ms = 250;
    for (int i = 0; i < block.cells(); ++i)
      block.raw[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(vector.raw(i));

    const auto back = decoded<TileBlock>(golden(vector.name), header);
    EXPECT_EQ(back.tx, block.tx);
    EXPECT_EQ(back.ty, block.ty);
    EXPECT_EQ(back.tile_rev, block.tile_rev);
    EXPECT_EQ(back.layer, block.layer);
    EXPECT_EQ(back.row0, block.row0);
    EXPECT_EQ(back.rows, block.rows);
    EXPECT_EQ(back.scale, block.scale);
    EXPECT_EQ(back.offset, block.offset);
    EXPECT_EQ(back.block_age_ms, block.block_age_ms);
    EXPECT_TRUE(std::equal(back.view().begin(), back.view().end(), block.view().begin(), block.view().end()));
    expect_encodes_to(header, block, golden(vector.name));
  }
}

TEST(GoldenVectors, ManifestNamesTheRevisionOfEachTile) {
  const Header header = golden_header(MessageType::manifest);
  Manifest manifest;
  manifest.tx0 = -4;
  manifest.ty0 = 5;
  manifest.columns = 3;
  manifest.rows = 2;
  manifest.layer = 1;
  for (std::uint32_t i = 0; i < 6; ++i) manifest.tile_rev[i] = 40 + i;
  const auto back = decoded<Manifest>(golden("manifest"), header);
  EXPECT_EQ(back.tx0, manifest.tx0);
  EXPECT_EQ(back.ty0, manifest.ty0);
  EXPECT_EQ(back.columns, manifest.columns);
  EXPECT_EQ(back.rows, manifest.rows);
  EXPECT_EQ(back.layer, manifest.layer);
  EXPECT_EQ(back.tile_rev, manifest.tile_rev);
  expect_encodes_to(header, manifest, golden("manifest"));
}

TEST(GoldenVectors, Heartbeat) {
  Header header = golden_header(MessageType::heartbeat);
  header.flags = kFlagClockLocked;
  Heartbeat heartbeat{61234, 1200, 3, 50'000'000, 8000, 15000, 22000, 49, 2, {}};
  heartbeat.sensors[0] = {0, SensorState::ok, 12};
  heartbeat.sensors[1] = {1, SensorState::lost, 5000};
  EXPECT_EQ(decoded<Heartbeat>(golden("heartbeat"), header), heartbeat);
  expect_encodes_to(header, heartbeat, golden("heartbeat"));
}

TEST(GoldenVectors, ReaderSkipsWhatALaterMinorVersionAdds) {
  Header header = golden_header(MessageType::heartbeat);
  header.ver_minor = 1;
  const Heartbeat expected{1, 2, 3, 4, 5, 6, 7, 8, 0, {}};
  EXPECT_EQ(decoded<Heartbeat>(golden("heartbeat_minor_1"), header), expected);
}

Key golden_key(std::uint16_t id) {
  Key key{id, {}};
  for (std::size_t i = 0; i < kKeyBytes; ++i) key.bytes[i] = static_cast<std::uint8_t>(id == 1 ? i : 255 - i);
  return key;
}

TEST(GoldenVectors, MacIsRefusedByAReaderWithoutKey) {
  const auto bytes = golden("heartbeat_mac");
  Opened opened;
  ASSERT_EQ(bytes.size(), kHeaderBytes + kHeartbeatBytes + kMacBytes);
  EXPECT_EQ(open_datagram(bytes, opened), Reject::mac);
}

TEST(GoldenVectors, Bye) {
  Header header = golden_header(MessageType::bye);
  header.flags = kFlagRepeat;
  EXPECT_EQ(decoded<Bye>(golden("bye"), header).reason, ByeReason::stopped);
  expect_encodes_to(header, Bye{ByeReason::stopped}, golden("bye"));
}

TEST(GoldenVectors, PoseInput) {
  const Header header = golden_header(MessageType::pose_input);
  PoseInputMessage message;
  message.time = Time(Duration(1700000000000000000));
  message.T_map_body.translation_m = {1.5, -2.25, 0.125};
  message.T_map_body.rotation = Eigen::Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  message.variances = {0.25f, 0.25f, 0.5f, 0.0f, 0.0f, 0.0625f};
  const auto back = decoded<PoseInputMessage>(golden("pose_input"), header);
  EXPECT_EQ(back.time, message.time);
  EXPECT_EQ(back.T_map_body.translation_m, message.T_map_body.translation_m);
  EXPECT_TRUE(back.T_map_body.rotation.isApprox(message.T_map_body.rotation, 1e-15));
  EXPECT_EQ(back.variances, message.variances);
  expect_encodes_to(header, message, golden("pose_input"));
}

/// Decodes with the key of `id`, and encodes with it to the same bytes.
template <class Message>
Message signed_both_ways(const char* name, Header header, std::uint16_t id) {
  const auto bytes = golden(name);
  KeyRing keys;
  EXPECT_TRUE(keys.add(golden_key(id)));
  Opened opened;
  EXPECT_EQ(open_datagram(bytes, opened, keys), Reject::none) << name;
  header.flags |= kFlagMac;
  header.key_id = id;
  EXPECT_EQ(opened.header, header) << name;
  Message message;
  EXPECT_EQ(decode(opened, message), Reject::none) << name;
  Datagram datagram;
  encode(header, message, datagram, keys.signer());
  EXPECT_EQ(std::vector<std::uint8_t>(datagram.view().begin(), datagram.view().end()), bytes) << name;
  return message;
}

Header golden_request(MessageType type, std::uint64_t seq = 1) {
  Header header;
  header.type = type;
  header.stream_id = 7;
  header.boot_id = 0x0123456789ABCDEF;
  header.seq = seq;
  return header;
}

TEST(GoldenVectors, MacsOfBothKeysAreThoseOfPython) {
  const Heartbeat heartbeat{1, 2, 3, 4, 5, 6, 7, 8, 0, {}};
  const Header header = golden_header(MessageType::heartbeat);
  EXPECT_EQ(signed_both_ways<Heartbeat>("heartbeat_mac", header, 1), heartbeat);
  EXPECT_EQ(signed_both_ways<Heartbeat>("heartbeat_mac_2", header, 513), heartbeat);
  const auto tile = signed_both_ways<TileBlock>("tile_cost_raw_mac", golden_header(MessageType::tile), 1);
  EXPECT_EQ(tile.raw[1], 10);
  const auto pose = signed_both_ways<PoseInputMessage>("pose_input_mac", golden_header(MessageType::pose_input), 1);
  EXPECT_EQ(pose.T_map_body.translation_m.y(), -2.25);
}

TEST(GoldenVectors, Pose) {
  const Header header = golden_header(MessageType::pose);
  const auto back = decoded<PoseMessage>(golden("pose"), header);
  EXPECT_EQ(back.time, Time(Duration(1700000000000000000)));
  EXPECT_EQ(back.T_map_body.translation_m, Eigen::Vector3d(1.5, -2.25, 0.125));
  EXPECT_EQ(back.variances, (std::array{0.25f, 0.25f, 0.5f, 0.0f, 0.0f, 0.0625f}));
  EXPECT_EQ(back.age_us, 1500u);
  PoseMessage message = back;
  message.T_map_body.rotation = Eigen::Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  EXPECT_TRUE(back.T_map_body.rotation.isApprox(message.T_map_body.rotation, 1e-15));
  expect_encodes_to(header, message, golden("pose"));
}

constexpr std::uint64_t kCookieValue = 0x1122334455667788;

TEST(GoldenVectors, Subscribe) {
  const Header first = golden_request(MessageType::subscribe);
  const Subscribe everything{0, 0x403, {}, 0, 0};
  EXPECT_EQ(decoded<Subscribe>(golden("subscribe_first"), first), everything);
  expect_encodes_to(first, everything, golden("subscribe_first"));

  const Header second = golden_request(MessageType::subscribe, 2);
  const Subscribe region{kCookieValue, 1, {-4, 5, 3, 9}, 500, 2};
  EXPECT_EQ(decoded<Subscribe>(golden("subscribe"), second), region);
  expect_encodes_to(second, region, golden("subscribe"));
  EXPECT_EQ(signed_both_ways<Subscribe>("subscribe_mac", second, 1), region);

  const Header third = golden_request(MessageType::subscribe, 3);
  const Subscribe end{kCookieValue, 0, {}, 0, 0};
  EXPECT_EQ(decoded<Subscribe>(golden("subscribe_end"), third), end);
  expect_encodes_to(third, end, golden("subscribe_end"));
}

TEST(GoldenVectors, CookieOfASubscriber) {
  const Header header = golden_header(MessageType::cookie);
  const Cookie cookie{kCookieValue, 3000};
  EXPECT_EQ(decoded<Cookie>(golden("cookie"), header), cookie);
  expect_encodes_to(header, cookie, golden("cookie"));
}

TEST(GoldenVectors, NackOfThreeTilesAndOfAsManyAsFit) {
  const Header header = golden_request(MessageType::nack, 4);
  Nack nack{kCookieValue, Layer::elevation, 3, {}};
  nack.tiles[0] = {-4, 5};
  nack.tiles[1] = {-(1 << 26), (1 << 26) - 1};
  const auto back = decoded<Nack>(golden("nack"), header);
  EXPECT_EQ(back.cookie, nack.cookie);
  EXPECT_EQ(back.layer, nack.layer);
  EXPECT_EQ(back.count, nack.count);
  EXPECT_EQ(back.tiles, nack.tiles);
  expect_encodes_to(header, nack, golden("nack"));

  Nack full{kCookieValue, Layer::cell_state, 128, {}};
  for (int i = 0; i < 128; ++i) full.tiles[static_cast<std::size_t>(i)] = {i, -i};
  EXPECT_EQ(decoded<Nack>(golden("nack_full"), golden_request(MessageType::nack)).tiles, full.tiles);
  expect_encodes_to(golden_request(MessageType::nack), full, golden("nack_full"));
}

TEST(GoldenVectors, PingAndPong) {
  const Ping ping{0xFEDCBA9876543210, 1700000000000000000};
  EXPECT_EQ(decoded<Ping>(golden("ping"), golden_request(MessageType::ping, 5)), ping);
  expect_encodes_to(golden_request(MessageType::ping, 5), ping, golden("ping"));
  const Pong pong{0xFEDCBA9876543210, 1700000000000000000, 1700000000000250000, 1700000000000300000};
  EXPECT_EQ(decoded<Pong>(golden("pong"), golden_header(MessageType::pong)), pong);
  expect_encodes_to(golden_header(MessageType::pong), pong, golden("pong"));
}

}  // namespace
}  // namespace scree::node::protocol
