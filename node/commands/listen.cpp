// scree listen: what a planner would see.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <set>
#include <spdlog/spdlog.h>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "config/mac_keys.hpp"
#include "core/time.hpp"
#include "node/commands/command_line.hpp"
#include "node/listen_report.hpp"
#include "node/listener.hpp"
#include "node/map_output.hpp"
#include "node/published_map.hpp"
#include "node/signals.hpp"

namespace scree::node {
namespace {

struct ListenOptions {
  std::optional<std::string> address;
  std::optional<std::string> node;
  std::optional<std::string> interface_;
  std::vector<std::string> keys;
  std::optional<std::string> layers;
  std::uint32_t stream_id = 1;
  int repeats = 0;
  std::string accept = "live,replay,sim,hil";
  std::optional<std::string> duration;
  OutputOptions output;
};

Result<std::set<drivers::Origin>> parse_origins(const std::string& text) {
  std::set<drivers::Origin> origins;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto origin = parse_origin(word);
    if (!origin)
      return Error{ErrorKind::usage, "--accept: expected a list of live, replay, sim, hil, found '" + word + "'"};
    origins.insert(*origin);
  }
  if (origins.empty()) return Error{ErrorKind::usage, "--accept: expected at least one origin, found none"};
  return origins;
}

Result<std::optional<Duration>> parse_duration(const std::optional<std::string>& text) {
  if (!text) return std::optional<Duration>();
  const auto parsed = parse_seconds(*text);
  if (parsed && parsed->count() >= 0) return std::optional(*parsed);
  return Error{ErrorKind::usage, "--duration: expected seconds of at least 0, found '" + *text + "'"};
}

/// "ID:FILE", each once.
Result<protocol::KeyRing> parse_keys(const std::vector<std::string>& words) {
  protocol::KeyRing ring;
  for (const std::string& word : words) {
    const std::size_t colon = word.find(':');
    unsigned id = 0;
    const auto parsed = std::from_chars(word.data(), word.data() + std::min(colon, word.size()), id);
    if (colon == std::string::npos || parsed.ptr != word.data() + colon || id < 1 || id > 65535)
      return Error{ErrorKind::usage, "--key: expected ID:FILE with an id from 1 to 65535, found '" + word + "'"};
    const auto key = config::read_key_file(static_cast<std::uint16_t>(id), word.substr(colon + 1));
    if (!key) return Error{key.error().kind, "--key: " + key.error().message};
    if (!ring.add({key->id, key->bytes}))
      return Error{ErrorKind::usage, fmt::format("--key: expected at most {} keys with different ids, found '{}'",
                                                 protocol::KeyRing::kCapacity, word)};
  }
  return ring;
}

Result<std::uint64_t> parse_layers(const std::optional<std::string>& text) {
  if (!text) return ~std::uint64_t{0};
  std::uint64_t mask = 0;
  std::istringstream words(*text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto format = std::find_if(protocol::kLayers.begin(), protocol::kLayers.end(),
                                     [&](const protocol::LayerFormat& layer) { return layer.name == word; });
    if (format == protocol::kLayers.end())
      return Error{ErrorKind::usage,
                   "--layers: expected a list of layers such as cost,elevation, found '" + word + "'"};
    mask |= layer_bit(format->layer);
  }
  if (mask != 0) return mask;
  return Error{ErrorKind::usage, "--layers: expected at least one layer, found none"};
}

/// Without an address: the default one, or with a node on this machine any port that is free.
Result<std::string> address_of(const ListenOptions& options) {
  if (options.address) return *options.address;
  if (!options.node) return std::string("127.0.0.1:47800");
  if (options.node->starts_with("127.") || options.node->starts_with("localhost:")) return std::string("127.0.0.1:0");
  return Error{ErrorKind::usage, "--address: expected the address of this machine that the node " + *options.node +
                                     " reaches, found none"};
}

Result<ListenerConfig> parse_config(const ListenOptions& options) {
  ListenerConfig config;
  auto origins = parse_origins(options.accept);
  if (!origins) return origins.error();
  const auto keys = parse_keys(options.keys);
  if (!keys) return keys.error();
  const auto layers = parse_layers(options.layers);
  if (!layers) return layers.error();
  const auto address = address_of(options);
  if (!address) return address.error();
  config.address = *address;
  config.multicast_interface = options.interface_.value_or("");
  config.accept = *std::move(origins);
  config.keys = *keys;
  config.node = options.node;
  if (options.node) config.stream_id = options.stream_id;
  config.wish.layer_mask = *layers;
  config.wish.repeats = static_cast<std::uint8_t>(options.repeats);
  return config;
}

/// Until BYE, the end of `duration`, or a signal. Says each change of the link once.
Status receive(Listener& listener, SignalWatch& signals, std::optional<Duration> duration) {
  const auto end = duration ? std::optional(MonotonicClock::now() + *duration) : std::nullopt;
  LinkState link = LinkState::waiting;
  while (!listener.ended() && !(end && MonotonicClock::now() >= *end)) {
    const auto received = listener.poll(std::chrono::milliseconds(20));
    if (!received) return received.error();
    if (listener.link() != link) {
      link = listener.link();
      spdlog::info("{}", describe_link(listener));
    }
    if (signals.wait(std::chrono::milliseconds(0))) break;
  }
  return {};
}

Status write_outputs(const ListenOptions& options, const std::string& address,
                     const std::optional<MapOutput>& map_output, const Listener& listener) {
  const auto map = listener.last_valid_map();
  const std::string json = listen_json(listener, map.get());
  const Status printed = options.output.json ? print(json + '\n') : Status{};  // whether or not a map came
  spdlog::info("{}", listen_line(listener, map.get()));
  if (!map_output && !options.output.snapshot) return printed;
  if (map == nullptr)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected a map, found {} datagrams without one", address,
                                                  listener.counters().datagrams)};
  if (map_output) {
    if (auto written = map_output->write(*map, json, announced_layers(listener)); !written) return written;
  }
  if (!options.output.snapshot) return printed;
  const auto source = fmt::format("{} received at {}", origin_name(listener.origin()), address);
  if (auto written = write_snapshot_picture(*options.output.snapshot, *map, source, RobotPlace::unknown); !written)
    return written;
  spdlog::info("picture: {}", *options.output.snapshot);
  return printed;
}

Result<int> run_listen(const ListenOptions& options) {
  const auto config = parse_config(options);
  if (!config) return config.error();
  const auto duration = parse_duration(options.duration);
  if (!duration) return duration.error();
  std::optional<MapOutput> map_output;
  if (options.output.map_out) {
    auto prepared = MapOutput::prepare(*options.output.map_out);
    if (!prepared) return prepared.error();
    map_output = *std::move(prepared);
  }
  if (options.output.snapshot) {
    if (const auto possible = check_picture_path("--snapshot", *options.output.snapshot); !possible)
      return possible.error();
  }

  SignalWatch signals;
  auto listener = Listener::open(*config);
  if (!listener) return listener.error();
  std::string address = config->address;
  address.replace(address.rfind(':') + 1, std::string::npos, std::to_string((*listener)->port()));
  spdlog::info("listening at {}{}", address, options.node ? ", asking " + *options.node : "");
  if (const auto received = receive(**listener, signals, *duration); !received) return received.error();
  signals.release();
  if (const auto written = write_outputs(options, address, map_output, **listener); !written) return written.error();
  return 0;
}

}  // namespace

Command add_listen(CLI::App& app) {
  auto options = std::make_shared<ListenOptions>();
  CLI::App* command = app.add_subcommand("listen", "A UDP client: receives the map as a planner would");
  command->add_option("--address", options->address, "Where datagrams arrive, also a group; default 127.0.0.1:47800")
      ->type_name("A:P");
  command->add_option("--node", options->node, "Subscribe at this node (its publish.listen); ask for what is missing")
      ->type_name("A:P");
  command->add_option("--layers", options->layers, "With --node: these alone, e.g. cost,elevation")->type_name("LIST");
  command->add_option("--repeats", options->repeats, "With --node: extra copies of each changed block, 0 to 3")
      ->check(CLI::Range(0, 3))
      ->type_name("N");
  command->add_option("--stream", options->stream_id, "With --node: its publish.stream_id; default 1")->type_name("N");
  command->add_option("--key", options->keys, "Key that the MAC must be of; the first also signs; repeatable")
      ->type_name("ID:FILE")
      ->allow_extra_args(false);
  command->add_option("--interface", options->interface_, "Address of the interface for a group")->type_name("A");
  command->add_option("--accept", options->accept, "Origins taken; default all: live,replay,sim,hil")
      ->type_name("LIST");
  command->add_option("--duration", options->duration, "Stop after this long; else at BYE or SIGINT")->type_name("S");
  options->output.add_to(*command);
  return {command, [options] { return run_listen(*options); }};
}

}  // namespace scree::node
