// Who may sign: keys, their roll-over, and every way in which a MAC can be wrong.

#include <gtest/gtest.h>
#include <vector>

#include "node/protocol.hpp"

namespace scree::node::protocol {
namespace {

Key key_of(std::uint16_t id, std::uint8_t fill) {
  Key key{id, {}};
  key.bytes.fill(fill);
  return key;
}

KeyRing ring_of(std::initializer_list<Key> keys) {
  KeyRing ring;
  for (const Key& key : keys) EXPECT_TRUE(ring.add(key));
  return ring;
}

std::vector<std::uint8_t> bye_signed_with(const Key* key) {
  Datagram datagram;
  encode(Header{}, Bye{ByeReason::stopped}, datagram, key);
  return {datagram.view().begin(), datagram.view().end()};
}

Reject opened_with(const std::vector<std::uint8_t>& bytes, const KeyRing& keys) {
  Opened opened;
  return open_datagram(bytes, opened, keys);
}

TEST(Mac, KeyedBlake2bOfTheReference) {
  // RFC 7693's own vectors have no key; these 16 bytes are hashlib.blake2b(b"abc", key=bytes(range(32)),
  // digest_size=16)
  Key key{1, {}};
  for (std::size_t i = 0; i < kKeyBytes; ++i) key.bytes[i] = static_cast<std::uint8_t>(i);
  const Mac expected = {0x1A, 0x64, 0xBE, 0x47, 0xE4, 0x72, 0x9D, 0x95, 0x1C, 0x30, 0x2E, 0xE5, 0x43, 0xF9, 0x7C, 0xF3};
  const std::vector<std::uint8_t> abc = {'a', 'b', 'c'};
  EXPECT_EQ(compute_mac(abc, key.bytes), expected);
  EXPECT_TRUE(mac_matches(abc, key, expected));
}

TEST(Mac, RingHoldsTwoKeysOfDifferentIds) {
  KeyRing ring;
  EXPECT_EQ(ring.signer(), nullptr);
  EXPECT_FALSE(ring.add(key_of(0, 1)));
  EXPECT_TRUE(ring.add(key_of(7, 1)));
  EXPECT_FALSE(ring.add(key_of(7, 2)));
  EXPECT_TRUE(ring.add(key_of(9, 2)));
  EXPECT_FALSE(ring.add(key_of(11, 3)));
  EXPECT_EQ(ring.signer()->id, 7);
  EXPECT_EQ(ring.find(9)->bytes[0], 2);
  EXPECT_EQ(ring.find(11), nullptr);
}

TEST(Mac, EitherOfTwoKeysVerifiesAndNoOther) {
  const Key old_key = key_of(1, 0xAA), new_key = key_of(2, 0xBB), stranger = key_of(3, 0xCC);
  const KeyRing both = ring_of({new_key, old_key});
  EXPECT_EQ(opened_with(bye_signed_with(&old_key), both), Reject::none);
  EXPECT_EQ(opened_with(bye_signed_with(&new_key), both), Reject::none);
  EXPECT_EQ(opened_with(bye_signed_with(&stranger), both), Reject::mac);
  EXPECT_EQ(opened_with(bye_signed_with(&old_key), ring_of({new_key})), Reject::mac);
  const Key impostor = key_of(1, 0xCC);  // a known id, another key
  EXPECT_EQ(opened_with(bye_signed_with(&impostor), both), Reject::mac);
}

TEST(Mac, IsDemandedWithAKeyAndRefusedWithout) {
  const Key key = key_of(1, 0xAA);
  EXPECT_EQ(opened_with(bye_signed_with(nullptr), ring_of({key})), Reject::mac);
  EXPECT_EQ(opened_with(bye_signed_with(&key), kNoKeys), Reject::mac);
  EXPECT_EQ(opened_with(bye_signed_with(nullptr), kNoKeys), Reject::none);
}

TEST(Mac, EveryBitOfADatagramIsCovered) {
  const Key key = key_of(1, 0xAA);
  const KeyRing ring = ring_of({key});
  const auto good = bye_signed_with(&key);
  ASSERT_EQ(opened_with(good, ring), Reject::none);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    EXPECT_NE(opened_with(bytes, ring), Reject::none) << "bit " << bit;
    // whoever changes a datagram repairs its CRC too; then the MAC is what is left
    const bool before_mac = bit / 8 < good.size() - kMacBytes;
    if (!before_mac || bit / 8 < 12 || (bit / 8 >= 60 && bit / 8 < 64)) continue;
    const std::uint32_t crc = datagram_crc(std::span(bytes).first(bytes.size() - kMacBytes));
    for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    EXPECT_EQ(opened_with(bytes, ring), Reject::mac) << "bit " << bit;
  }
}

TEST(Mac, TakenOffIsRefused) {
  const Key key = key_of(1, 0xAA);
  auto bytes = bye_signed_with(&key);
  bytes.resize(bytes.size() - kMacBytes);
  bytes[7] &= static_cast<std::uint8_t>(~kFlagMac);
  bytes[10] = static_cast<std::uint8_t>(bytes.size());
  const std::uint32_t crc = datagram_crc(bytes);
  for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  EXPECT_EQ(opened_with(bytes, kNoKeys), Reject::none);
  EXPECT_EQ(opened_with(bytes, ring_of({key})), Reject::mac);
}

}  // namespace
}  // namespace scree::node::protocol
