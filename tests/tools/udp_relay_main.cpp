// udp_relay: a bad network between a node and a client, for trying things out by hand (docs/client.md has an example).

#include <CLI/CLI.hpp>
#include <csignal>
#include <fmt/format.h>

#include "tests/support/udp_relay.hpp"

namespace {

using namespace scree::test;

volatile std::sig_atomic_t stop_requested = 0;
volatile std::sig_atomic_t black_out = 0;

std::string text(const BadNetworkCounters& c) {
  return fmt::format(
      R"({{"received": {}, "delivered": {}, "lost": {}, "blacked_out": {}, "duplicated": {}, "reordered": {}, "corrupted": {}, "truncated": {}}})",
      c.received, c.delivered, c.lost, c.blacked_out, c.duplicated, c.reordered, c.corrupted, c.truncated);
}

void add_options(CLI::App& app, BadNetworkSettings& settings, double& delay_ms, double& jitter_ms, double& held_ms) {
  app.add_option("--loss", settings.loss, "share lost, each by itself")->check(CLI::Range(0.0, 1.0));
  app.add_option("--burst-loss", settings.burst_loss, "share lost in bursts")->check(CLI::Range(0.0, 0.9));
  app.add_option("--burst-length", settings.burst_length, "mean datagrams of a burst")->check(CLI::Range(1.0, 1e6));
  app.add_option("--duplicate", settings.duplicate, "share sent twice")->check(CLI::Range(0.0, 1.0));
  app.add_option("--reorder", settings.reorder, "share held back")->check(CLI::Range(0.0, 1.0));
  app.add_option("--corrupt", settings.corrupt, "share with flipped bits")->check(CLI::Range(0.0, 1.0));
  app.add_option("--truncate", settings.truncate, "share cut short")->check(CLI::Range(0.0, 1.0));
  app.add_option("--delay-ms", delay_ms, "of each way")->check(CLI::Range(0.0, 1e5));
  app.add_option("--jitter-ms", jitter_ms, "on top, uniform")->check(CLI::Range(0.0, 1e5));
  app.add_option("--held-back-ms", held_ms, "what --reorder adds")->check(CLI::Range(0.0, 1e5));
}

Nanoseconds from_ms(double ms) {
  return Nanoseconds(static_cast<std::int64_t>(ms * 1e6));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "A bad network between a node and a client, the same for the same seed. SIGUSR1 begins and ends a black-out."};
  std::string near = "127.0.0.1:47901", far = "127.0.0.1:47900", node, client;
  UdpRelaySettings settings;
  double delay_ms = 0.0, jitter_ms = 0.0, held_ms = 3.0;
  app.add_option("--near", near, "where clients send requests")->capture_default_str();
  app.add_option("--far", far, "where the node sends the map")->capture_default_str();
  app.add_option("--node", node, "where requests go, e.g. 127.0.0.1:47801");
  app.add_option("--client", client, "where the map goes, e.g. 127.0.0.1:47800; without it to who sent to --near");
  app.add_option("--seed", settings.seed, "of everything that is random")->capture_default_str();
  add_options(app, settings.down, delay_ms, jitter_ms, held_ms);
  CLI11_PARSE(app, argc, argv);
  settings.down.delay = from_ms(delay_ms);
  settings.down.jitter = from_ms(jitter_ms);
  settings.down.reorder_delay = from_ms(held_ms);
  settings.up = settings.down;
  const auto near_address = parse_ipv4(near), far_address = parse_ipv4(far);
  settings.node = parse_ipv4(node);
  settings.client = parse_ipv4(client);
  if (!near_address || !far_address || (!node.empty() && !settings.node) || (!client.empty() && !settings.client)) {
    fmt::print(stderr, "udp_relay: expected addresses such as 127.0.0.1:47800\n");
    return 64;
  }
  settings.near = *near_address;
  settings.far = *far_address;
  const auto relay = UdpRelay::open(settings);
  if (relay == nullptr) {
    fmt::print(stderr, "udp_relay: {} or {} is not free\n", near, far);
    return 69;
  }
  std::signal(SIGINT, [](int) { stop_requested = 1; });
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
  std::signal(SIGUSR1, [](int) { black_out = black_out == 0 ? 1 : 0; });
  fmt::print(stderr, "udp_relay: near 127.0.0.1:{} far 127.0.0.1:{}\n", relay->near_port(), relay->far_port());
  while (stop_requested == 0) {
    relay->set_black_out(black_out != 0);
    relay->run_once(std::chrono::milliseconds(20));
  }
  fmt::print("{{\"down\": {}, \"up\": {}, \"without_destination\": {}}}\n", text(relay->down()), text(relay->up()),
             relay->without_destination());
  return 0;
}
