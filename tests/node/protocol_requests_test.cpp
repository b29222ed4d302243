// Bodies of the requests that the golden vectors do not show: lengths and values out of bounds.

#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "node/protocol.hpp"
#include "tests/node/golden.hpp"

namespace scree::node::protocol {
namespace {

using test::golden;

void repair(std::vector<std::uint8_t>& bytes) {
  bytes[10] = static_cast<std::uint8_t>(bytes.size());
  bytes[11] = static_cast<std::uint8_t>(bytes.size() >> 8);
  const std::uint32_t crc = datagram_crc(bytes);
  for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

/// What decode says of the vector `name` after `change` to its body.
template <class Message>
Reject after(const char* name, const std::function<void(std::vector<std::uint8_t>&)>& change) {
  auto bytes = golden(name);
  change(bytes);
  repair(bytes);
  Opened opened;
  EXPECT_EQ(open_datagram(bytes, opened), Reject::none);
  Message message;
  return decode(opened, message);
}

std::function<void(std::vector<std::uint8_t>&)> body_byte(std::size_t at, std::uint8_t value) {
  return [=](auto& bytes) { bytes[kHeaderBytes + at] = value; };
}

template <class Message>
void expect_exact_length(const char* name) {
  EXPECT_EQ(after<Message>(name, [](auto&) {}), Reject::none) << name;
  EXPECT_EQ(after<Message>(name, [](auto& b) { b.push_back(0); }), Reject::body_length) << name;
  EXPECT_EQ(after<Message>(name, [](auto& b) { b.pop_back(); }), Reject::body_length) << name;
  EXPECT_EQ(after<Message>(name, [](auto& b) { b.resize(kHeaderBytes); }), Reject::body_length) << name;
  const auto later_minor = [](auto& b) {
    b[5] = 1;
    b.push_back(0);
  };
  EXPECT_EQ(after<Message>(name, later_minor), Reject::none) << name;
}

TEST(Requests, BodiesHaveExactlyTheirLength) {
  expect_exact_length<Subscribe>("subscribe");
  expect_exact_length<Cookie>("cookie");
  expect_exact_length<Nack>("nack");
  expect_exact_length<Ping>("ping");
  expect_exact_length<Pong>("pong");
  expect_exact_length<PoseMessage>("pose");
}

TEST(Requests, SubscriptionIsARegionWithAtMostThreeRepeats) {
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(36, 3)), Reject::none);
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(36, 4)), Reject::body_value);
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(24, 0xFB)), Reject::none);        // tx_max 251
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(27, 0x7F)), Reject::body_value);  // tx_max beyond 2^26
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(19, 0x80)), Reject::body_value);  // tx_min below -2^26
  EXPECT_EQ(after<Subscribe>("subscribe", body_byte(28, 4)), Reject::body_value);     // ty_max 4 < ty_min 5
}

TEST(Requests, CookieIsNeverZero) {
  EXPECT_EQ(after<Cookie>("cookie", [](auto& b) { std::fill_n(b.begin() + kHeaderBytes, 8, std::uint8_t{0}); }),
            Reject::body_value);
  EXPECT_EQ(after<Cookie>("cookie", [](auto& b) { std::fill_n(b.begin() + kHeaderBytes + 8, 4, std::uint8_t{0}); }),
            Reject::body_value);
}

TEST(Requests, NackNamesOneTo128TilesOfAKnownLayer) {
  EXPECT_EQ(after<Nack>("nack", body_byte(9, 0)), Reject::body_value);
  EXPECT_EQ(after<Nack>("nack", body_byte(9, 129)), Reject::body_value);
  EXPECT_EQ(after<Nack>("nack", body_byte(9, 2)), Reject::body_length);
  EXPECT_EQ(after<Nack>("nack", body_byte(8, kLayerCount)), Reject::layer);
  EXPECT_EQ(after<Nack>("nack", body_byte(19, 0x80)), Reject::body_value);  // tx far below -2^26
}

TEST(Requests, PoseIsWithinTheBoundsOfPoseInput) {
  EXPECT_EQ(after<PoseMessage>("pose", body_byte(63, 0x7F)), Reject::body_value);         // qw
  EXPECT_EQ(after<PoseMessage>("pose", body_byte(67, 0x80 | 0x3E)), Reject::body_value);  // a negative variance
  EXPECT_EQ(after<PoseMessage>("pose", body_byte(7, 0x7F)), Reject::body_value);          // time
}

}  // namespace
}  // namespace scree::node::protocol
