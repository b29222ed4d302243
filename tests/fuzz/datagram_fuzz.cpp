// The receiver's whole way from bytes to map, and every decoder. An input is a session: for each datagram a u16 length,
// a u8 of milliseconds since the one before, and the bytes. So that the fuzzer gets past them, total_len, CRC and MAC
// are repaired unless the milliseconds are odd, and seq unless their next bit is set. Two receivers listen, one with
// keys and one without: each datagram is of use to one of them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "node/listener_assembly.hpp"
#include "node/pose_input.hpp"
#include "node/protocol.hpp"

namespace {

using namespace scree;
using namespace scree::node;

protocol::KeyRing make_keys() {
  protocol::KeyRing keys;
  for (std::uint16_t id = 1; id <= 2; ++id) (void)keys.add({id, {0x5A, static_cast<std::uint8_t>(id)}});
  return keys;
}
const protocol::KeyRing kKeys = make_keys();

void repair(std::vector<std::uint8_t>& bytes, bool number, std::uint64_t seq) {
  if (bytes.size() < protocol::kHeaderBytes) return;
  const bool has_mac = (bytes[7] & protocol::kFlagMac) != 0;
  if (has_mac && bytes.size() < protocol::kHeaderBytes + protocol::kMacBytes) return;
  bytes[10] = static_cast<std::uint8_t>(bytes.size());
  bytes[11] = static_cast<std::uint8_t>(bytes.size() >> 8);
  for (std::size_t i = 0; i < 8 && number; ++i) bytes[24 + i] = static_cast<std::uint8_t>(seq >> (8 * i));
  if (has_mac) {
    bytes[56] = static_cast<std::uint8_t>(1 + bytes[56] % 2);
    bytes[57] = 0;
  }
  const std::size_t end = bytes.size() - (has_mac ? protocol::kMacBytes : 0);
  const std::uint32_t crc = protocol::datagram_crc(std::span(bytes).first(end));
  for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  if (!has_mac) return;
  const auto mac = protocol::compute_mac(std::span(bytes).first(end), kKeys.find(bytes[56])->bytes);
  std::copy(mac.begin(), mac.end(), bytes.begin() + static_cast<std::ptrdiff_t>(end));
}

void expect(bool condition) {
  if (!condition) std::abort();
}

/// What a decoder takes, the encoder writes again, and it is the same message.
template <class Message>
void check_codec(const protocol::Opened& opened) {
  Message message;
  if (decode(opened, message) != protocol::Reject::none || opened.header.ver_minor != 0) return;
  const bool has_mac = (opened.header.flags & protocol::kFlagMac) != 0;
  const protocol::Key* const key = has_mac ? kKeys.find(opened.header.key_id) : nullptr;
  protocol::Datagram again;
  encode(opened.header, message, again, key);
  protocol::Opened reopened;
  Message back;
  expect(open_datagram(again.view(), reopened, has_mac ? kKeys : protocol::kNoKeys) == protocol::Reject::none);
  expect(decode(reopened, back) == protocol::Reject::none);
  protocol::Datagram third;
  encode(opened.header, back, third, key);
  expect(std::ranges::equal(again.view(), third.view()));
}

void check_codecs(std::span<const std::uint8_t> bytes) {
  using namespace protocol;
  Opened opened;
  if (open_datagram(bytes, opened, kKeys) != Reject::none && open_datagram(bytes, opened) != Reject::none) return;
  check_codec<Subscribe>(opened);
  check_codec<Cookie>(opened);
  check_codec<Nack>(opened);
  check_codec<Ping>(opened);
  check_codec<Pong>(opened);
  check_codec<Manifest>(opened);
  check_codec<Heartbeat>(opened);
  check_codec<Announce>(opened);
  check_codec<TileBlock>(opened);
}

/// A map never has anything but what its invariants allow, however it came about.
void check_map(const MapAssembly& assembly, MonotonicTime now) {
  const auto& announce = assembly.announce();
  if (!announce || std::int64_t{announce->window.rows} * announce->window.columns > 10'000) return;  // too slow
  const auto map = assembly.map(now);
  const bool valid = assembly.link() == LinkState::fresh || assembly.link() == LinkState::stale;
  for (std::size_t i = 0; i < map->cost.size(); ++i) {
    expect(map->state[i] <= CellState::measured);
    expect(valid || map->cost[i] == mapping::kCostUnknown);
  }
}

/// Every datagram is counted under one reason, and after two silent seconds nothing is valid any more.
void check_end(MapAssembly& assembly, MonotonicTime now) {
  const ListenerCounters& counters = assembly.counters();
  expect(counters.datagrams == counters.accepted + counters.rejected + counters.refused_origin + counters.ignored);
  check_map(assembly, now);
  assembly.advance(now + std::chrono::seconds(2));
  expect(assembly.link() == LinkState::lost || assembly.link() == LinkState::waiting);
  check_map(assembly, now + std::chrono::seconds(2));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::set<drivers::Origin> accept = {drivers::Origin::live, drivers::Origin::sim};
  MapAssembly assembly(accept), with_keys(accept, std::nullopt, kKeys);
  const Endpoint from = *parse_endpoint("127.0.0.1:1", "fuzz");
  PoseReceiver poses(from, 7);
  MonotonicTime now = MonotonicTime{} + std::chrono::hours(1);
  std::uint64_t seq = 0;
  std::span<const std::uint8_t> input(data, size);
  while (input.size() >= 3) {
    const std::size_t length = std::min<std::size_t>(input[0] | input[1] << 8, input.size() - 3);
    const std::uint8_t milliseconds = input[2];
    std::vector<std::uint8_t> bytes(input.begin() + 3, input.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    input = input.subspan(3 + length);
    ++seq;
    if (milliseconds % 2 == 0) repair(bytes, milliseconds % 4 == 0, seq);
    now += std::chrono::milliseconds(milliseconds);
    (void)assembly.accept(bytes, now);
    (void)with_keys.accept(bytes, now);
    check_codecs(bytes);
    (void)poses.accept(bytes, from, Time(std::chrono::hours(1'000'000)));
  }
  check_end(assembly, now);
  check_end(with_keys, now);
  return 0;
}
