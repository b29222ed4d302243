// The receiver's whole way from bytes to map. An input is a session: for each datagram a u16 length, a u8 of
// milliseconds since the one before, and the bytes. So that the fuzzer gets past them, total_len and CRC are repaired
// unless the milliseconds are odd, and seq unless their next bit is set.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "node/listener_assembly.hpp"
#include "node/pose_input.hpp"
#include "node/protocol.hpp"

namespace {

using namespace scree;
using namespace scree::node;

void repair(std::vector<std::uint8_t>& bytes, bool number, std::uint64_t seq) {
  if (bytes.size() < protocol::kHeaderBytes) return;
  const bool has_mac = (bytes[7] & protocol::kFlagMac) != 0;
  if (has_mac && bytes.size() < protocol::kHeaderBytes + protocol::kMacBytes) return;
  bytes[10] = static_cast<std::uint8_t>(bytes.size());
  bytes[11] = static_cast<std::uint8_t>(bytes.size() >> 8);
  for (std::size_t i = 0; i < 8 && number; ++i) bytes[24 + i] = static_cast<std::uint8_t>(seq >> (8 * i));
  const std::size_t end = bytes.size() - (has_mac ? protocol::kMacBytes : 0);
  const std::uint32_t crc = protocol::datagram_crc(std::span(bytes).first(end));
  for (std::size_t i = 0; i < 4; ++i) bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

void expect(bool condition) {
  if (!condition) std::abort();
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  MapAssembly assembly({drivers::Origin::live, drivers::Origin::sim});
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
    (void)poses.accept(bytes, from, Time(std::chrono::hours(1'000'000)));
  }
  const ListenerCounters& counters = assembly.counters();
  expect(counters.datagrams == counters.accepted + counters.rejected + counters.refused_origin + counters.ignored);
  check_map(assembly, now);
  assembly.advance(now + std::chrono::seconds(2));
  expect(assembly.link() == LinkState::lost || assembly.link() == LinkState::waiting);
  check_map(assembly, now + std::chrono::seconds(2));
  return 0;
}
