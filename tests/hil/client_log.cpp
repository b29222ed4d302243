// A client of the node that writes down what a planner would know of its health, ten times a second, until BYE or
// SIGTERM. Usage: client_log NODE (its publish.listen). A line:
//
//   UPTIME_S STATE HEALTH FRAMES_IN FRAMES_DROPPED ORIGIN MAP_REV DATA_AGE_MS SENSORS [SENSOR STATE AGE_MS]…
//
// DATA_AGE_MS: since the map's newest sample came to the node; -1 before the first map.

#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>

#include "client/scree_client.hpp"

namespace {

volatile std::sig_atomic_t stopped = 0;

void stop(int) {
  stopped = 1;
}

double uptime_s() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void write_line(const scree::client::Client& map) {
  const scree::client::Heartbeat none, *beat = map.heartbeat() == nullptr ? &none : map.heartbeat();
  const auto now = scree::client::Clock::now();
  const auto age_ms = std::chrono::duration_cast<std::chrono::milliseconds>(map.data_age(now)).count();
  std::printf("%.3f %d %d %llu %llu %d %u %lld %d", uptime_s(), static_cast<int>(map.state()),
              static_cast<int>(map.health()), static_cast<unsigned long long>(beat->frames_in),
              static_cast<unsigned long long>(beat->frames_dropped), static_cast<int>(map.origin()),
              static_cast<unsigned>(map.map_rev()), map.t_data_ns() == 0 ? -1LL : static_cast<long long>(age_ms),
              static_cast<int>(beat->sensors));
  for (int i = 0; i < beat->sensors; ++i)
    std::printf(" %d %d %u", static_cast<int>(beat->sensor[i].sensor), static_cast<int>(beat->sensor[i].state),
                static_cast<unsigned>(beat->sensor[i].age_ms));
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: client_log NODE\n"), 64;
  std::signal(SIGTERM, stop);
  std::signal(SIGINT, stop);
  scree::client::Config config;
  config.bind = "127.0.0.1:0";
  config.node = argv[1];
  config.accept_origins = scree::client::origin_bit(scree::client::Origin::hil);
  scree::client::Client map;
  if (!map.open(config)) return std::fprintf(stderr, "client_log: %s\n", map.error()), 1;
  auto next = scree::client::Clock::now();
  while (stopped == 0 && !map.ended()) {
    map.wait(std::chrono::milliseconds(20));
    map.poll();
    if (scree::client::Clock::now() < next) continue;
    write_line(map);
    next += std::chrono::milliseconds(100);
  }
  write_line(map);
  return 0;
}
