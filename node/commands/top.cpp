// scree top: a running node in a terminal.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <unistd.h>

#include "node/commands/command_line.hpp"
#include "node/signals.hpp"
#include "node/top_view.hpp"

namespace scree::node {
namespace {

struct TopOptions {
  std::optional<std::string> address, node;
  std::uint32_t stream_id = 1;
  double interval_s = 1.0;
  int count = 0;
};

client::Config client_config(const TopOptions& options, const std::string& address) {
  using client::Origin;
  client::Config config;
  config.bind = address.c_str();
  config.node = options.node ? options.node->c_str() : nullptr;
  config.stream_id = options.node ? std::int64_t{options.stream_id} : client::Config::kAnyStream;
  config.layers = client::layer_bit(client::Layer::cost);
  config.max_window_tiles = 65 * 65;
  config.accept_origins = client::origin_bit(Origin::live) | client::origin_bit(Origin::replay) |
                          client::origin_bit(Origin::sim) | client::origin_bit(Origin::hil);
  return config;
}

/// Redraws in place on a terminal, else appends.
Status show(const std::string& text) {
  static const bool on_terminal = ::isatty(STDOUT_FILENO) != 0;
  return print(on_terminal ? "\x1b[H\x1b[2J" + text + "\nCtrl-C ends\n" : text + "\n");
}

Result<int> run_top(const TopOptions& options) {
  const std::string address = options.address.value_or(options.node ? "127.0.0.1:0" : "127.0.0.1:47800");
  SignalWatch signals;
  const auto map = std::make_unique<client::Client>();
  if (!map->open(client_config(options, address)))
    return Error{ErrorKind::unavailable, fmt::format("scree top: {}", map->error())};
  TopView view;
  const auto interval = std::chrono::duration_cast<client::Duration>(std::chrono::duration<double>(options.interval_s));
  client::Time next = client::Clock::now() + interval;
  for (int shown = 0; options.count == 0 || shown < options.count;) {
    map->wait(std::chrono::milliseconds(20));
    map->poll();
    if (signals.wait(std::chrono::milliseconds(0))) break;
    const client::Time now = client::Clock::now();
    if (now < next) continue;
    if (const Status shown_now = show(view.text(*map, now)); !shown_now) return shown_now.error();
    next = now + interval;
    ++shown;
  }
  return 0;
}

}  // namespace

Command add_top(CLI::App& app) {
  auto options = std::make_shared<TopOptions>();
  CLI::App* command = app.add_subcommand("top", "A running node in a terminal: heartbeat, rates, loss, ages");
  command->add_option("--address", options->address, "Where datagrams arrive; default 127.0.0.1:47800")
      ->type_name("A:P");
  command->add_option("--node", options->node, "Subscribe at this node (its publish.listen) instead")->type_name("A:P");
  command->add_option("--stream", options->stream_id, "With --node: its publish.stream_id; default 1")->type_name("N");
  command->add_option("--interval", options->interval_s, "Seconds from view to view; default 1")
      ->check(CLI::Range(0.1, 3600.0))
      ->type_name("S");
  command->add_option("--count", options->count, "End after so many views; default at Ctrl-C")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  return {command, [options] { return run_top(*options); }};
}

}  // namespace scree::node
