#include "node/protocol.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "core/random.hpp"
#include "node/tile_window.hpp"
#include "tests/node/golden.hpp"

namespace scree::node::protocol {
namespace {

using test::golden;

// Written by hand from the offset table; the CRC by zlib's definition, bit by bit, below.
constexpr std::array<std::uint8_t, 72> kByeByHand = {
    'S',  'C',  'R',  'E',                           // magic
    1,    0,    11,   0x28,                          // version 1.0, BYE, flags: clock locked + origin SIM
    64,   0,    72,   0,                             // header_len, total_len
    0x04, 0x03, 0x02, 0x01,                          // stream_id
    0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11,  // boot_id
    0x28, 0x27, 0x26, 0x25, 0x24, 0x23, 0x22, 0x21,  // seq
    0x38, 0x37, 0x36, 0x35, 0x34, 0x33, 0x32, 0x31,  // t_data_ns
    0x44, 0x43, 0x42, 0x41,                          // age_us
    0x54, 0x53, 0x52, 0x51,                          // map_rev
    0x02, 0x80,                                      // health: sensor lost, FAULT
    0x62, 0x61,                                      // cost_profile
    0x74, 0x73, 0x72, 0x71,                          // config_hash
    0,    0,    0,    0,                             // key_id, reserved
    0,    0,    0,    0,                             // crc32, filled in by the test
    3,    0,    0,    0,    0,    0,    0,    0,     // BYE: reason 3, reserved
};

/// CRC-32 (reflected 0x04C11DB7, initial and final inversion), one bit at a time.
std::uint32_t crc32_bit_by_bit(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

void repair_crc(std::vector<std::uint8_t>& bytes) {
  std::fill_n(bytes.begin() + 60, 4, std::uint8_t{0});
  const std::uint32_t crc = crc32_bit_by_bit(bytes);
  for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

std::vector<std::uint8_t> bye_by_hand() {
  std::vector<std::uint8_t> bytes(kByeByHand.begin(), kByeByHand.end());
  repair_crc(bytes);
  return bytes;
}

TEST(Header, AgreesWithBytesWrittenByHand) {
  const Header header{.type = MessageType::bye,
                      .flags = kFlagClockLocked,
                      .origin = drivers::Origin::sim,
                      .stream_id = 0x01020304,
                      .boot_id = 0x1112131415161718,
                      .seq = 0x2122232425262728,
                      .t_data_ns = 0x3132333435363738,
                      .age_us = 0x41424344,
                      .map_rev = 0x51525354,
                      .health = kHealthSensorLost | kHealthFault,
                      .cost_profile = 0x6162,
                      .config_hash = 0x71727374};
  Datagram datagram;
  encode(header, Bye{ByeReason::restart}, datagram);
  EXPECT_EQ(std::vector<std::uint8_t>(datagram.view().begin(), datagram.view().end()), bye_by_hand());

  Opened opened;
  ASSERT_EQ(open_datagram(bye_by_hand(), opened), Reject::none);
  EXPECT_EQ(opened.header, header);
}

TEST(Header, ChecksInTheOrderOfTheTable) {
  Opened opened;
  const auto rejected = [&](const std::function<void(std::vector<std::uint8_t>&)>& spoil, bool repair) {
    auto bytes = bye_by_hand();
    spoil(bytes);
    if (repair) repair_crc(bytes);
    return open_datagram(bytes, opened);
  };
  EXPECT_EQ(rejected([](auto& b) { b.resize(63); }, false), Reject::too_short);
  EXPECT_EQ(rejected([](auto& b) { b.resize(1201); }, false), Reject::too_long);
  EXPECT_EQ(rejected([](auto& b) { b[3] = 'X', b[4] = 9; }, false), Reject::magic);
  EXPECT_EQ(rejected([](auto& b) { b[4] = 2, b[10] = 0; }, true), Reject::version);
  EXPECT_EQ(rejected([](auto& b) { b[10] = 71, b[8] = 3; }, true), Reject::total_length);
  EXPECT_EQ(rejected([](auto& b) { b.pop_back(); }, true), Reject::total_length);
  EXPECT_EQ(rejected([](auto& b) { b[8] = 63; }, true), Reject::header_length);
  EXPECT_EQ(rejected([](auto& b) { b[8] = 73; }, true), Reject::header_length);
  EXPECT_EQ(rejected([](auto& b) { b[30] ^= 1; }, false), Reject::crc);
  EXPECT_EQ(rejected([](auto& b) { b[7] |= kFlagMac; }, true), Reject::too_short);
  EXPECT_EQ(rejected([](auto&) {}, true), Reject::none);
}

TEST(Header, EverySingleBitErrorIsFound) {
  const auto good = golden("heartbeat");
  Opened opened;
  ASSERT_EQ(open_datagram(good, opened), Reject::none);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    auto bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    EXPECT_NE(open_datagram(bytes, opened), Reject::none) << "bit " << bit;
  }
}

TEST(ConfigHash, IsTheBeginningOfBlake2b) {
  EXPECT_EQ(config_hash("abc"), 0x3fa580bau);  // RFC 7693, appendix A: BA 80 A5 3F …
}

/// A golden vector with bytes of the body replaced and the CRC made right again.
Reject decode_spoiled(const std::string& name, std::size_t body_offset, std::vector<std::uint8_t> replacement) {
  auto bytes = golden(name);
  for (std::size_t i = 0; i < replacement.size(); ++i) bytes[64 + body_offset + i] = replacement[i];
  repair_crc(bytes);
  Opened opened;
  if (const Reject reason = open_datagram(bytes, opened); reason != Reject::none) return reason;
  switch (opened.header.type) {
    case MessageType::announce: {
      Announce m;
      return decode(opened, m);
    }
    case MessageType::tile: {
      TileBlock m;
      return decode(opened, m);
    }
    case MessageType::manifest: {
      Manifest m;
      return decode(opened, m);
    }
    case MessageType::heartbeat: {
      Heartbeat m;
      return decode(opened, m);
    }
    case MessageType::pose_input: {
      PoseInputMessage m;
      return decode(opened, m);
    }
    default:
      return Reject::type;
  }
}

TEST(Tile, FieldsOutOfBoundsAreRejected) {
  const auto spoiled = [](std::size_t offset, std::vector<std::uint8_t> bytes) {
    return decode_spoiled("tile_cost_raw", offset, std::move(bytes));
  };
  EXPECT_EQ(spoiled(0, {0, 0, 0, 4}), Reject::body_value);  // tx = 2^26
  EXPECT_EQ(spoiled(12, {11}), Reject::layer);
  EXPECT_EQ(spoiled(13, {1}), Reject::body_value);   // i16 for a layer of u8
  EXPECT_EQ(spoiled(13, {3}), Reject::body_length);  // constant with 1024 bytes
  EXPECT_EQ(spoiled(13, {4}), Reject::body_value);   // run-length whose first run is beyond the tile, or zero
  EXPECT_EQ(spoiled(13, {5}), Reject::body_value);
  EXPECT_EQ(spoiled(14, {6}), Reject::body_value);                 // tile_log2
  EXPECT_EQ(spoiled(15, {1}), Reject::body_value);                 // row0
  EXPECT_EQ(spoiled(16, {16}), Reject::body_value);                // rows
  EXPECT_EQ(spoiled(18, {0, 0}), Reject::body_value);              // known_cells
  EXPECT_EQ(spoiled(20, {0, 0, 0, 0}), Reject::body_value);        // scale 0
  EXPECT_EQ(spoiled(20, {0, 0, 0x80, 0x7f}), Reject::body_value);  // scale infinite
  EXPECT_EQ(spoiled(24, {0, 0, 0xc0, 0x7f}), Reject::body_value);  // offset NaN
  EXPECT_EQ(decode_spoiled("tile_elevation_upper", 15, {8}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("tile_elevation_upper", 13, {4}), Reject::body_value);  // run-length is for u8
}

TEST(Tile, RunLengthMustFillTheBlockExactly) {
  // tile_cost_run_length begins with the runs (255, 255) (45, 255)
  EXPECT_EQ(decode_spoiled("tile_cost_run_length", 32, {254}), Reject::body_length);
  EXPECT_EQ(decode_spoiled("tile_cost_run_length", 34, {46}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("tile_cost_run_length", 32, {0}), Reject::body_value);
}

TEST(Tile, RunLengthIsUsedOnlyWhereShorter) {
  TileBlock block;
  Datagram datagram;
  // 511 runs of two and two single cells make 1026 bytes: raw is shorter; 512 runs make 1024, no gain: raw
  for (const int singles : {2, 0}) {
    for (int i = 0; i < kTileArea; ++i)
      block.raw[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(((i + singles / 2) / 2) % 2);
    encode(Header{}, block, datagram);
    EXPECT_EQ(datagram.bytes[64 + 13], static_cast<std::uint8_t>(Encoding::u8));
    EXPECT_EQ(datagram.size, 64u + 32u + 1024u);
  }
  for (int i = 0; i < 4; ++i) block.raw[static_cast<std::size_t>(i)] = 1;  // merges runs: now shorter
  encode(Header{}, block, datagram);
  EXPECT_EQ(datagram.bytes[64 + 13], static_cast<std::uint8_t>(Encoding::run_length));
  EXPECT_LT(datagram.size, 64u + 32u + 1024u);
}

// 11 layers × 200 blocks of runs with random lengths, both halves of the 16-bit layer.
TEST(Tile, RandomBlocksSurviveTheRoundTrip) {
  for (std::int32_t trial = 0; trial < 200; ++trial) {
    for (const LayerFormat& format : kLayers) {
      TileBlock block;
      block.layer = format.layer;
      const auto words = random_words(1, static_cast<std::uint64_t>(format.layer), trial, 0);
      block.tx = static_cast<std::int32_t>(words[0] % (1u << 27)) - (1 << 26);
      block.ty = static_cast<std::int32_t>(words[1] % (1u << 27)) - (1 << 26);
      if (format.encoding == Encoding::i16) {
        block.rows = kHalfRows;
        block.row0 = words[2] % 2 ? kHalfRows : 0;
      }
      const std::uint32_t mean_run = 1 + words[3] % 40;
      std::int16_t value = 0;
      for (int i = 0; i < block.cells(); ++i) {
        const auto draw = random_words(2, static_cast<std::uint64_t>(format.layer), trial, i);
        if (i == 0 || draw[0] % mean_run == 0)
          value = static_cast<std::int16_t>(format.encoding == Encoding::i16 ? draw[1] : draw[1] % 256);
        block.raw[static_cast<std::size_t>(i)] = value;
      }
      Datagram datagram;
      encode(Header{}, block, datagram);
      ASSERT_LE(datagram.size, kMaxDatagramBytes);
      Opened opened;
      TileBlock back;
      ASSERT_EQ(open_datagram(datagram.view(), opened), Reject::none);
      ASSERT_EQ(decode(opened, back), Reject::none);
      ASSERT_EQ(back.tx, block.tx);
      ASSERT_EQ(back.ty, block.ty);
      ASSERT_TRUE(std::equal(back.view().begin(), back.view().end(), block.view().begin(), block.view().end()));
    }
  }
}

TEST(Announce, ContradictionsAreRejected) {
  const auto spoiled = [](std::size_t offset, std::vector<std::uint8_t> bytes) {
    return decode_spoiled("announce", offset, std::move(bytes));
  };
  EXPECT_EQ(spoiled(8, std::vector<std::uint8_t>(8, 0)), Reject::body_value);       // resolution 0
  EXPECT_EQ(spoiled(16, {0, 0, 0, 0, 0, 0, 0xf8, 0x7f}), Reject::body_value);       // half an anchor
  EXPECT_EQ(spoiled(48, {0xfb}), Reject::body_value);                               // tx_min is not the cells'
  EXPECT_EQ(spoiled(72, {0, 0, 0, 0}), Reject::body_value);                         // no columns
  EXPECT_EQ(spoiled(72, {0xff, 0xff, 0xff, 0x7f}), Reject::body_value);             // far too many
  EXPECT_EQ(spoiled(84, {1, 0, 0, 0}), Reject::body_value);                         // lost before stale
  EXPECT_EQ(spoiled(100, {4}), Reject::body_value);                                 // tile_log2
  EXPECT_EQ(spoiled(101, {6}), Reject::body_length);                                // a layer too many
  EXPECT_EQ(spoiled(104, {0}), Reject::body_value);                                 // empty name
  EXPECT_EQ(spoiled(104, {0x1b}), Reject::body_value);                              // control character
  EXPECT_EQ(spoiled(104, std::vector<std::uint8_t>(32, 'a')), Reject::body_value);  // no end
  EXPECT_EQ(spoiled(212, {0}), Reject::body_value);                                 // layer 0 twice
}

TEST(Manifest, RectangleIsBounded) {
  EXPECT_EQ(decode_spoiled("manifest", 8, {4, 0}), Reject::body_length);
  EXPECT_EQ(decode_spoiled("manifest", 8, {0, 0}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("manifest", 8, {0xff, 0xff, 0xff, 0xff}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("manifest", 0, {0xff, 0xff, 0xff, 0x03}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("manifest", 12, {200}), Reject::layer);
}

TEST(PoseInputMessage, MustBeFiniteAndARotation) {
  EXPECT_EQ(decode_spoiled("pose_input", 8, {0, 0, 0, 0, 0, 0, 0xf0, 0x7f}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("pose_input", 56, {0, 0, 0, 0, 0, 0, 0xf0, 0x3f}), Reject::body_value);  // norm √1.5
  EXPECT_EQ(decode_spoiled("pose_input", 32, {0, 0, 0, 0, 0, 0, 0xf8, 0x7f}), Reject::body_value);
  EXPECT_EQ(decode_spoiled("pose_input", 64, {0, 0, 0x80, 0xbf}), Reject::body_value);  // variance −1
}

TEST(SequenceWindow, CountsGapsOnceAndFindsDuplicates) {
  using Verdict = SequenceWindow::Verdict;
  SequenceWindow window;
  EXPECT_EQ(window.lost(), 0u);
  EXPECT_EQ(window.note(10), Verdict::fresh);
  EXPECT_EQ(window.note(14), Verdict::fresh);
  EXPECT_EQ(window.lost(), 3u);
  EXPECT_EQ(window.note(12), Verdict::fresh);  // late, not lost
  EXPECT_EQ(window.lost(), 2u);
  EXPECT_EQ(window.note(12), Verdict::duplicate);
  EXPECT_EQ(window.note(14 + 5000), Verdict::fresh);
  EXPECT_EQ(window.note(14), Verdict::too_old);
  EXPECT_EQ(window.note(5013), Verdict::fresh);
  EXPECT_EQ(window.lost(), 2u + 4998u);
}

TEST(TileWindow, IsTheTilesThatTheCellsTouch) {
  EXPECT_EQ(tiles_touched({{0, 0}, 32, 32}), (TileWindow{{0, 0}, 1, 1}));
  EXPECT_EQ(tiles_touched({{-1, 31}, 2, 2}), (TileWindow{{-1, 0}, 2, 2}));
  EXPECT_EQ(tiles_touched({{-64, -33}, 1, 200}), (TileWindow{{-2, -2}, 1, 7}));
}

}  // namespace
}  // namespace scree::node::protocol
