// The C++ client, from bytes to costs and requests. An input is a session: for each datagram a u16 length, a u8 of
// milliseconds since the one before, and the bytes. So that the fuzzer gets past them, lengths and CRC are repaired
// unless the milliseconds are odd, and seq unless their next bit is set; a second client with a key gets the same
// datagrams with the right MAC. The node's own receiver is the oracle: it must judge every datagram in the same way and
// never know another cost.

#include <cmath>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "client/scree_client.hpp"
#include "node/listener_assembly.hpp"

namespace {

using namespace scree;
using client::Verdict;

void expect(bool condition) {
  if (!condition) std::abort();
}

client::Key key() {
  client::Key out{9, {}};
  out.bytes.fill(0x6B);
  return out;
}

void repair(std::vector<std::uint8_t>& bytes, bool number, std::uint64_t seq) {
  if (bytes.size() < 64) return;
  bytes[7] &= 0xFE;
  client::detail::put(&bytes[10], bytes.size(), 2);
  if (number) client::detail::put(&bytes[24], seq, 8);
  client::detail::put(&bytes[60], client::detail::datagram_crc(bytes.data(), bytes.size()), 4);
}

std::vector<std::uint8_t> with_mac(std::vector<std::uint8_t> bytes) {
  const std::size_t end = bytes.size();
  if (end < 64) return bytes;
  bytes[7] |= 1;
  bytes.resize(end + 16);
  client::detail::put(&bytes[10], bytes.size(), 2);
  client::detail::put(&bytes[56], key().id, 2);
  client::detail::put(&bytes[60], client::detail::datagram_crc(bytes.data(), end), 4);
  std::uint8_t mac[16];
  client::detail::datagram_mac(key(), bytes.data(), end, mac);
  std::copy(mac, mac + 16, bytes.end() - 16);
  return bytes;
}

class Session {
 public:
  explicit Session(bool keyed) {
    client::Config config;
    config.stream_id = 7;
    config.node = "127.0.0.1:1";
    config.layers = 0x7FF;
    config.max_window_tiles = 6;
    config.accept_origins = client::origin_bit(client::Origin::live) | client::origin_bit(client::Origin::sim);
    if (keyed) config.keys[0] = key();
    expect(receiver.open(config, client::Time{}));
  }

  Verdict take(const std::vector<std::uint8_t>& bytes, client::Time now) {
    // a copy of the exact size: what is read behind it is seen
    const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[bytes.size()]);
    std::copy(bytes.begin(), bytes.end(), exact.get());
    const Verdict verdict = receiver.accept(exact.get(), bytes.size(), now);
    std::uint8_t request[client::detail::kMaxDatagramBytes];
    for (int i = 0; receiver.next_request(request, now) > 0; ++i) expect(i < 100);
    return verdict;
  }

  void check(client::Time now) const {
    const client::Grid grid = receiver.grid();
    std::vector<std::uint8_t> cost(grid.cells());
    std::vector<float> values(grid.cells());
    expect(receiver.copy_cost(cost.data(), cost.size(), now) == (grid.columns > 0));
    const client::State state = receiver.state(now);
    const bool valid = state == client::State::fresh || state == client::State::stale;
    for (std::size_t i = 0; i < cost.size(); i += 37) {
      const auto column = static_cast<std::int64_t>(i % grid.columns),
                 row = static_cast<std::int64_t>(i / grid.columns);
      expect(receiver.cost_of_cell(grid.x_min_cells + column, grid.y_min_cells + row, now) == cost[i]);
      expect(valid || cost[i] == client::kCostUnknown);
      expect(receiver.cell_state_of_cell(grid.x_min_cells + column, grid.y_min_cells + row, now) <=
             client::CellState::measured);
    }
    for (std::size_t layer = 0; layer < client::kLayers; ++layer)
      (void)receiver.copy_layer(static_cast<client::Layer>(layer), values.data(), values.size(), now);
    std::uint64_t sum = 0;
    for (const std::uint64_t count : receiver.counters().by_verdict) sum += count;
    expect(sum == receiver.counters().datagrams);
    (void)receiver.cost(0.3, -7.0, now);
    (void)receiver.cost(std::nan(""), 1e300, now);
  }

  client::Receiver receiver;
};

/// The types that both receivers know, of the version that both know.
bool comparable(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 64) return true;
  return bytes[5] == 0 && ((bytes[6] >= 1 && bytes[6] <= 4) || bytes[6] == 11);
}

void compare_costs(const client::Receiver& ours, client::Time now, const node::MapAssembly& theirs,
                   MonotonicTime then) {
  const client::Grid grid = ours.grid();
  const auto map = theirs.map(then);
  if (map == nullptr || grid.columns == 0) return;
  expect(map->window.columns == static_cast<int>(grid.columns) && map->window.rows == static_cast<int>(grid.rows));
  std::vector<std::uint8_t> cost(grid.cells());
  expect(ours.copy_cost(cost.data(), cost.size(), now));
  for (std::size_t i = 0; i < cost.size(); ++i)
    expect(cost[i] == map->cost[i] || cost[i] == client::kCostUnknown || map->cost[i] == mapping::kCostUnknown);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Session plain(false), signed_too(true), compared(false);
  node::MapAssembly oracle({drivers::Origin::live, drivers::Origin::sim}, 7);
  client::Time now = client::Time{} + std::chrono::hours(1);
  MonotonicTime then = MonotonicTime{} + std::chrono::hours(1);
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
    then += std::chrono::milliseconds(milliseconds);
    (void)plain.take(bytes, now);
    (void)signed_too.take(with_mac(bytes), now);
    if (comparable(bytes))
      expect(static_cast<int>(compared.take(bytes, now)) == static_cast<int>(oracle.accept(bytes, then)));
  }
  plain.check(now);
  signed_too.check(now);
  compare_costs(compared.receiver, now, oracle, then);
  const client::State later = plain.receiver.state(now + std::chrono::seconds(2));
  expect(later == client::State::lost || later == client::State::waiting);
  plain.check(now + std::chrono::seconds(2));
  return 0;
}
