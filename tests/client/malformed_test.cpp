// 10^6 malformed and 10^5 forged datagrams: no cell changes, nothing grows, every one is counted.

#include <gtest/gtest.h>

#include "core/random.hpp"
#include "tests/client/oracle.hpp"

namespace scree::test {
namespace {

constexpr Nanoseconds kNow = std::chrono::seconds(2);

class Malformed : public testing::TestWithParam<bool> {
 protected:
  static std::unique_ptr<ClientPort> open(const PortSettings& settings) {
    return GetParam() ? python_port(settings) : cpp_port(settings);
  }

  /// Two seconds of a map; what was sent in the second one.
  std::vector<std::vector<std::uint8_t>> feed(ClientPort& client, const MapSenderSettings& settings) {
    MapSender sender(settings);
    std::vector<std::vector<std::uint8_t>> sent;
    for (Nanoseconds now{0}; now <= kNow; now += std::chrono::milliseconds(10)) {
      sender.tick(now, [&](std::span<const std::uint8_t> datagram) {
        client.accept(datagram, now);
        if (now > kNow / 2) sent.emplace_back(datagram.begin(), datagram.end());
      });
    }
    return sent;
  }

  void expect_unchanged(const Shown& before, const Shown& after, std::uint64_t datagrams) {
    EXPECT_EQ(after.state, client::State::fresh);
    EXPECT_EQ(after.cost, before.cost);
    EXPECT_EQ(after.occupancy, before.occupancy);
    EXPECT_EQ(std::memcmp(after.elevation.data(), before.elevation.data(), 4 * before.elevation.size()), 0);
    EXPECT_EQ(std::memcmp(after.cell_state.data(), before.cell_state.data(), 4 * before.cell_state.size()), 0);
    EXPECT_FALSE(all_unknown(before));
    EXPECT_EQ(after.accepted, before.accepted);
    EXPECT_EQ(after.datagrams, before.datagrams + datagrams);
    // of Python's allocator's pools; a leak of two bytes each would be seen
    const std::uint64_t slack = GetParam() ? 2 << 20 : 0;
    EXPECT_LE(after.memory, before.memory + slack);
  }
};

/// A mutant of `datagram` that differs from it: bits flipped, cut, extended, fields overwritten, or noise altogether.
std::vector<std::uint8_t> mutant(const std::vector<std::uint8_t>& datagram, std::uint32_t i) {
  const auto a = random_words(11, 1, static_cast<std::int32_t>(i), 0),
             b = random_words(11, 2, static_cast<std::int32_t>(i), 0);
  auto out = datagram;
  switch (a[0] % 6) {
    case 0:
      out[a[1] % out.size()] ^= static_cast<std::uint8_t>(1U << (a[2] % 8));
      break;
    case 1:
      out.resize(a[1] % out.size());
      break;
    case 2:
      out.resize(out.size() + 1 + a[1] % 300, static_cast<std::uint8_t>(a[2]));
      break;
    case 3:  // a field of the header: version, type, flags, lengths, stream, sender, number
      out[4 + a[1] % 28] ^= static_cast<std::uint8_t>(1 + a[2] % 255);
      break;
    case 4:  // a burst
      for (std::uint32_t k = 0; k < 1 + a[3] % 40; ++k)
        out[(a[1] + k) % out.size()] ^= static_cast<std::uint8_t>(k == 0 ? 1 + b[0] % 255 : b[k % 4] >> (k % 24));
      break;
    default:
      out.resize(a[1] % 1400);
      for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::uint8_t>(b[k % 4] >> (k % 29));
  }
  return out;
}

/// Length and CRC made right again, as far as there is a header.
void repair(std::vector<std::uint8_t>& bytes) {
  const std::size_t end = bytes.size() - 16;
  client::detail::put(bytes.data() + 10, bytes.size(), 2);
  client::detail::put(bytes.data() + 60, client::detail::datagram_crc(bytes.data(), end), 4);
}

// A damaged datagram passes its CRC-32 with 2^-32: 2e-4 over all of them, and with this seed none does.
TEST_P(Malformed, AMillionMalformedDatagramsChangeNothing) {
  const auto client = open({});
  const auto sent = feed(*client, {});
  const Shown before = client->show(kNow);
  constexpr std::uint32_t kDatagrams = 1'000'000;
  for (std::uint32_t i = 0; i < kDatagrams; ++i) client->accept(mutant(sent[i % sent.size()], i), kNow);
  expect_unchanged(before, client->show(kNow), kDatagrams);
}

// With a key set: right in every respect (a CRC too) but the MAC, which is missing, of another key, or of other bytes.
TEST_P(Malformed, AHundredThousandForgedDatagramsChangeNothing) {
  client::Key key{7, {}};
  key.bytes.fill(0xA5);
  MapSenderSettings settings;
  settings.key = node::protocol::Key{key.id, key.bytes};
  const auto client = open({.subscribe = false, .repeats = 0, .key = key});
  const auto sent = feed(*client, settings);
  const Shown before = client->show(kNow);
  client::Key wrong = key;
  wrong.bytes[31] ^= 1;
  constexpr std::uint32_t kDatagrams = 100'000;
  for (std::uint32_t i = 0; i < kDatagrams; ++i) {
    auto bytes = sent[i % sent.size()];
    const auto words = random_words(12, 1, static_cast<std::int32_t>(i), 0);
    client::detail::put(bytes.data() + 24, 1'000'000 + i, 8);                    // a number that is still to come
    if (words[0] % 4 == 0) client::detail::put(bytes.data() + 16, words[1], 8);  // another sender
    bytes[64 + words[1] % (bytes.size() - 80)] ^= static_cast<std::uint8_t>(words[2]);
    repair(bytes);
    if (words[0] % 3 == 0) {
      std::uint8_t mac[16];
      client::detail::datagram_mac(wrong, bytes.data(), bytes.size() - 16, mac);
      std::copy(mac, mac + 16, bytes.end() - 16);
    } else if (words[0] % 3 == 1) {  // no MAC at all
      bytes[7] &= 0xFE;
      bytes.resize(bytes.size() - 16);
      client::detail::put(bytes.data() + 10, bytes.size(), 2);
      client::detail::put(bytes.data() + 60, client::detail::datagram_crc(bytes.data(), bytes.size()), 4);
    }
    client->accept(bytes, kNow);
  }
  expect_unchanged(before, client->show(kNow), kDatagrams);
}

INSTANTIATE_TEST_SUITE_P(Clients, Malformed, testing::Values(false, true),
                         [](const auto& instance) { return instance.param ? "Python" : "Cpp"; });

}  // namespace
}  // namespace scree::test
