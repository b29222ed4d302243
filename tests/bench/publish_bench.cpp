// What publishing costs the node: a map of 400 × 400 cells at 10 Hz in real time, 30 % of its tiles changing each time,
// sent over loopback. The share of one core is that of the publishing thread (its own CPU clock). Beside it the parts:
// cutting and quantising the map, and the same datagrams handed to the kernel in batches and one by one.

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <netinet/in.h>
#include <sys/socket.h>
#include <thread>
#include <time.h>
#include <unistd.h>
#include <vector>

#include "core/random.hpp"
#include "node/map_stream.hpp"
#include "node/published_map.hpp"
#include "node/tile_book.hpp"
#include "node/udp_socket.hpp"

namespace {

using namespace scree;
using namespace scree::node;
using namespace std::chrono_literals;

constexpr int kCells = 400;
constexpr int kMaps = 60;
constexpr Duration kPeriod = 100ms;
constexpr double kChanging = 0.3;

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A tile's content of one variant: rough ground, patches of unknown cells, costs that follow the roughness.
void fill_tile(mapping::MapSnapshot& map, int row0, int column0, std::uint64_t variant) {
  for (int r = row0; r < std::min(row0 + 32, kCells); ++r) {
    for (int c = column0; c < std::min(column0 + 32, kCells); ++c) {
      const auto words = random_words(variant, 0, c, r);
      const bool hole = std::sin(0.11 * c) + std::cos(0.13 * r) > 1.5;
      const float nan = std::numeric_limits<float>::quiet_NaN();
      map.cost(r, c) = hole ? mapping::kCostUnknown : static_cast<std::uint8_t>(words[0] % 120);
      map.state(r, c) = hole                ? CellState::never_seen
                        : words[1] % 8 == 0 ? CellState::reconstructed
                                            : CellState::measured;
      const double height = 2.0 * std::sin(0.02 * c) + std::cos(0.03 * r) + 0.05 * to_uniform(words[2]);
      map.elevation_m(r, c) = hole ? nan : static_cast<float>(height);
      map.dimension(r, c) = hole ? nan : static_cast<float>(2.2 + 0.3 * to_uniform(words[3]));
      map.amplitude_m(r, c) = hole ? nan : static_cast<float>(0.02 + 0.03 * to_uniform(words[1]));
      map.cell_age_s(r, c) = hole ? nan : static_cast<float>(2.0 * to_uniform(words[2]));
    }
  }
}

std::shared_ptr<mapping::MapSnapshot> first_map() {
  auto map = std::make_shared<mapping::MapSnapshot>();
  map->window = {{-200, -200}, kCells, kCells};
  map->cost.assign(kCells, kCells, mapping::kCostUnknown);
  map->state.assign(kCells, kCells, CellState::never_seen);
  for (auto* grid : {&map->elevation_m, &map->dimension, &map->amplitude_m, &map->cell_age_s})
    grid->assign(kCells, kCells, 0.0f);
  for (int r = 0; r < kCells; r += 32)
    for (int c = 0; c < kCells; c += 32) fill_tile(*map, r, c, 0);
  return map;
}

/// The tiles of the lattice that begin within 32 cells: row 8 of the map is on a tile's edge (−200 = −7·32 + 24).
std::vector<std::shared_ptr<mapping::MapSnapshot>> make_maps() {
  std::vector<std::shared_ptr<mapping::MapSnapshot>> maps;
  auto map = first_map();
  for (std::int32_t i = 0; i < kMaps; ++i) {
    auto next = std::make_shared<mapping::MapSnapshot>(*map);
    next->revision = static_cast<std::uint32_t>(i + 1);
    next->data_time = Time(std::chrono::seconds(1'700'000'000) + i * kPeriod);
    for (int r = -24; r < kCells; r += 32)
      for (int c = -24; c < kCells; c += 32)
        if (to_uniform(random_words(1, i, c, r)[0]) < kChanging)
          fill_tile(*next, std::max(r, 0), std::max(c, 0), static_cast<std::uint64_t>(i) + 1);
    maps.push_back(next);
    map = next;
  }
  return maps;
}

/// Reads what comes, on its own thread, and keeps the first few thousand datagrams.
struct Sink {
  UdpSocket socket = *UdpSocket::bind(*parse_endpoint("127.0.0.1:0", "bench"), "bench");
  std::vector<std::vector<std::uint8_t>> kept;
  std::atomic<std::uint64_t> datagrams = 0;
  std::jthread reader;

  void start() {
    reader = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested())
        (void)socket.receive(20ms, [&](std::span<const std::uint8_t> bytes, const Endpoint&) {
          if (kept.size() < 20'000) kept.emplace_back(bytes.begin(), bytes.end());
          ++datagrams;
        });
    });
  }
};

struct Run {
  double cpu_share = 0.0;
  double datagrams_per_s = 0.0;
  double megabit_per_s = 0.0;
  double latency_p50_ms = 0.0;
  double latency_p99_ms = 0.0;
  std::uint64_t lost = 0;
};

/// One destination in real time. The book is cut with all layers, whatever of them is sent.
Run publish(const std::vector<std::shared_ptr<mapping::MapSnapshot>>& maps, Sink& sink, std::uint64_t layer_mask) {
  PublishedMap map;
  map.cell_m = maps[0]->cell_m;
  StreamWish wish;
  wish.layer_mask = layer_mask;
  wish.datagrams_per_s = 10'000;
  const Endpoint to = *parse_endpoint("127.0.0.1:" + std::to_string(sink.socket.local_port()), "bench");
  auto socket = std::make_shared<UdpSocket>(*UdpSocket::connect_to(to, "bench"));
  MapStream stream(socket, std::nullopt, wish, 1, map);
  const auto tick = [&](MonotonicTime now) {
    map.look_at_system(now);
    return stream.tick(now, map);
  };
  const auto submit = [&](mapping::MapSnapshot& snapshot) {
    snapshot.received = MonotonicClock::now();
    map.take(snapshot);
    stream.note_map(map, false);
  };
  submit(*maps[0]);  // the whole map at once is not what is measured
  for (int i = 0; i < 400; ++i, std::this_thread::sleep_for(2ms)) tick(MonotonicClock::now());
  const PublisherCounters before = map.counters;
  const std::uint64_t received = sink.datagrams;
  const double cpu_before = thread_cpu_s();
  const MonotonicTime begin = MonotonicClock::now();
  LatencyHistogram latency;
  std::uint64_t out = map.generation;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    const MonotonicTime due = begin + static_cast<int>(i) * kPeriod;
    for (MonotonicTime now = MonotonicClock::now(); now < due; now = MonotonicClock::now()) {
      const Duration next = tick(now);
      if (stream.generation_out(map) > out) latency.add(MonotonicClock::now() - map.received);
      out = std::max(out, stream.generation_out(map));
      std::this_thread::sleep_for(std::min<Duration>(next, due - now));
    }
    submit(*maps[i]);
  }
  const double seconds = to_seconds(MonotonicClock::now() - begin);
  Run run;
  run.cpu_share = (thread_cpu_s() - cpu_before) / seconds;
  run.datagrams_per_s = static_cast<double>(map.counters.datagrams - before.datagrams) / seconds;
  run.megabit_per_s = 8e-6 * static_cast<double>(map.counters.bytes - before.bytes) / seconds;
  run.latency_p50_ms = 1e3 * to_seconds(latency.percentile(0.5));
  run.latency_p99_ms = 1e3 * to_seconds(latency.percentile(0.99));
  std::this_thread::sleep_for(100ms);
  run.lost = map.counters.datagrams - before.datagrams - (sink.datagrams - received);
  return run;
}

double book_cpu_s(const std::vector<std::shared_ptr<mapping::MapSnapshot>>& maps) {
  TileBook book;
  book.update(*maps[0]);
  const double before = thread_cpu_s();
  for (std::size_t i = 1; i < maps.size(); ++i) book.update(*maps[i]);
  return (thread_cpu_s() - before) / static_cast<double>(maps.size() - 1);
}

/// CPU seconds for each datagram, in batches of `batch`; 0 = plain sendto.
double send_cpu_s(const std::vector<std::vector<std::uint8_t>>& datagrams, std::uint16_t port, std::size_t batch) {
  const Endpoint to = *parse_endpoint("127.0.0.1:" + std::to_string(port), "bench");
  auto socket = *UdpSocket::connect_to(to, "bench");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int plain = ::socket(AF_INET, SOCK_DGRAM, 0);
  std::vector<std::span<const std::uint8_t>> views;
  double used = 0.0;
  for (std::size_t i = 0; i < datagrams.size(); i += 64) {
    const std::size_t end = std::min(i + 64, datagrams.size());
    const double before = thread_cpu_s();
    if (batch == 0) {
      for (std::size_t k = i; k < end; ++k)
        (void)sendto(plain, datagrams[k].data(), datagrams[k].size(), 0, reinterpret_cast<const sockaddr*>(&address),
                     sizeof address);
    } else {
      views.assign(datagrams.begin() + static_cast<std::ptrdiff_t>(i),
                   datagrams.begin() + static_cast<std::ptrdiff_t>(end));
      socket.send(views);
    }
    used += thread_cpu_s() - before;
    if (i % 640 == 0) std::this_thread::sleep_for(1ms);  // the reader keeps up
  }
  close(plain);
  return used / static_cast<double>(datagrams.size());
}

/// CPU seconds for the MAC of a datagram, the keyed hash of all its bytes.
double mac_cpu_s(const std::vector<std::vector<std::uint8_t>>& datagrams) {
  const std::array<std::uint8_t, protocol::kKeyBytes> key{1};
  std::uint8_t sum = 0;
  const double before = thread_cpu_s();
  for (const auto& datagram : datagrams) sum ^= protocol::compute_mac(datagram, key)[0];
  const double used = thread_cpu_s() - before;
  return used / static_cast<double>(datagrams.size()) + 1e-30 * sum;  // so that it is computed
}

void report(const char* layers, const Run& run, double batched_s, double plain_s) {
  const double plain_share = run.cpu_share + run.datagrams_per_s * (plain_s - batched_s);
  fmt::print("{}\n", layers);
  fmt::print("  share of one core      {:6.2f} %, of it handing to the kernel {:.2f} %\n", 100 * run.cpu_share,
             100 * run.datagrams_per_s * batched_s);
  fmt::print("  with one sendto each   {:6.2f} %, {:.2f} times as much\n", 100 * plain_share,
             plain_share / run.cpu_share);
  fmt::print("  datagrams              {:6.0f} /s, {:.1f} Mbit/s, {} not received\n", run.datagrams_per_s,
             run.megabit_per_s, run.lost);
  fmt::print("  map in to last block out: p50 {:.1f} ms, p99 {:.1f} ms\n", run.latency_p50_ms, run.latency_p99_ms);
}

}  // namespace

int main() {
  using protocol::Layer;
  const auto maps = make_maps();
  Sink sink;
  sink.start();
  const std::uint64_t four =
      layer_bit(Layer::cost) | layer_bit(Layer::elevation) | layer_bit(Layer::dimension) | layer_bit(Layer::amplitude);
  const Run run_of_four = publish(maps, sink, four);
  const Run run_of_all = publish(maps, sink, ~std::uint64_t{0});
  sink.reader = {};
  const auto datagrams = sink.kept;
  sink.start();
  const double book_s = book_cpu_s(maps);
  double batched_s = 1.0, plain_s = 1.0;
  for (int i = 0; i < 5; ++i) {  // the best of interleaved runs: what else the machine does falls on both
    batched_s = std::min(batched_s, send_cpu_s(datagrams, sink.socket.local_port(), 64));
    plain_s = std::min(plain_s, send_cpu_s(datagrams, sink.socket.local_port(), 0));
  }
  fmt::print("{} × {} cells, {:.0f} Hz, {:.0f} % of the tiles changing, refresh 1 s, pacing 10000 datagrams/s\n",
             kCells, kCells, 1.0 / to_seconds(kPeriod), 100 * kChanging);
  report("cost, elevation, dimension and amplitude sent", run_of_four, batched_s, plain_s);
  report("all layers sent", run_of_all, batched_s, plain_s);
  fmt::print("cutting and quantising all layers: {:.2f} ms a map, {:.2f} % of one core (in both)\n", 1e3 * book_s,
             100 * book_s / to_seconds(kPeriod));
  protocol::KeyRing ready;
  (void)ready.add({1, {}});  // as a node with keys does: the library chooses its fast BLAKE2b
  fmt::print("MAC: {:.2f} µs a datagram\n", 1e6 * mac_cpu_s(datagrams));
  fmt::print("kernel: {:.2f} µs a datagram in batches, {:.2f} µs by sendto\n", 1e6 * batched_s, 1e6 * plain_s);
  return 0;
}
