// send_map: the sender of tests/support/map_sender.hpp over a real socket, as fast as asked. For measuring receivers.

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "tests/support/map_sender.hpp"
#include "tests/support/udp_relay.hpp"

namespace {

using namespace scree::test;
using scree::node::protocol::Layer;

struct Options {
  std::string to = "127.0.0.1:47800";
  int size_cells = 400;
  double rate = 10.0, changing = 0.3, duration_s = 10.0, datagrams_per_s = 100'000.0;
  int layers = 4;
};

int send_map(const Options& options) {
  const auto to = parse_ipv4(options.to);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (!to || fd < 0) return fmt::print(stderr, "send_map: expected an address such as 127.0.0.1:47800\n"), 64;
  MapSenderSettings settings;
  settings.window = {{-7, 13}, options.size_cells, options.size_cells};
  const Layer order[] = {Layer::cost,      Layer::elevation, Layer::cell_state,
                         Layer::dimension, Layer::amplitude, Layer::cell_age};
  settings.layers.assign(order, order + options.layers);
  settings.changing = options.changing;
  settings.revisions_per_s = options.rate;
  settings.refresh_s = 10.0 / options.rate;
  settings.datagrams_per_s = options.datagrams_per_s;
  MapSender sender(settings);
  std::uint64_t sent = 0, failed = 0;
  const auto send = [&](std::span<const std::uint8_t> bytes) {
    const auto* const address = reinterpret_cast<const sockaddr*>(&*to);
    ++(sendto(fd, bytes.data(), bytes.size(), 0, address, sizeof *to) < 0 ? failed : sent);
  };
  const auto begin = std::chrono::steady_clock::now();
  for (Nanoseconds now{0}; now < Nanoseconds(static_cast<std::int64_t>(options.duration_s * 1e9));) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    now = std::chrono::steady_clock::now() - begin;
    sender.tick(now, send);
  }
  sender.say_bye(send);
  close(fd);
  fmt::print("{{\"sent\": {}, \"failed\": {}, \"revisions\": {}}}\n", sent, failed, sender.revision());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Sends a made-up map of changing tiles over UDP; prints how many datagrams that were."};
  Options options;
  app.add_option("--to", options.to, "destination")->capture_default_str();
  app.add_option("--size", options.size_cells, "cells along a side")->check(CLI::Range(1, 2000))->capture_default_str();
  app.add_option("--rate", options.rate, "revisions a second; ten of them refresh the map")->capture_default_str();
  app.add_option("--changing", options.changing, "share of the tiles that a revision changes")->capture_default_str();
  app.add_option("--layers", options.layers, "of cost, elevation, cell state, D, amplitude, age")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  app.add_option("--duration", options.duration_s, "seconds")->capture_default_str();
  app.add_option("--datagrams-per-s", options.datagrams_per_s, "pacing")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return send_map(options);
}
