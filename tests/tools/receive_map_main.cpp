// receive_map: the C++ client, measured: prints its port, receives until BYE or 2 s of silence, then prints what it
// got.

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <sys/resource.h>
#include <vector>

#include "client/scree_client.hpp"

namespace {

double cpu_s() {
  rusage usage{};
  (void)getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

int main() {
  using namespace std::chrono_literals;
  scree::client::Config config;
  config.bind = "127.0.0.1:0";
  const auto map = std::make_unique<scree::client::Client>();
  if (!map->open(config)) return fmt::print(stderr, "receive_map: {}\n", map->error()), 69;
  fmt::print("{}\n", map->port());
  std::fflush(stdout);
  (void)map->wait(20s);
  const double cpu_before = cpu_s();
  const auto begin = scree::client::Clock::now();
  auto last = begin, looked = begin;
  std::vector<std::uint8_t> cost;
  while (scree::client::Clock::now() - last < (map->ended() ? 100ms : 2000ms)) {
    (void)map->wait(20ms);
    if (map->poll()) last = scree::client::Clock::now();
    if (scree::client::Clock::now() - looked < 100ms) continue;
    looked = scree::client::Clock::now();  // as a planner would: the whole map ten times a second
    cost.resize(std::max(cost.size(), map->grid().cells()));
    (void)map->copy_cost(cost.data(), cost.size());
  }
  const double wall = std::chrono::duration<double>(last - begin).count();
  const auto& counters = map->counters();
  fmt::print("{{\"datagrams\": {}, \"accepted\": {}, \"overflowed\": {}, \"cpu_s\": {:.3f}, \"wall_s\": {:.3f}}}\n",
             counters.datagrams, counters[scree::client::Verdict::accepted], counters.overflowed, cpu_s() - cpu_before,
             wall);
  return 0;
}
