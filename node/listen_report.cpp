#include "node/listen_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "node/listener_client.hpp"
#include "node/protocol_layers.hpp"

namespace scree::node {

std::optional<drivers::Origin> parse_origin(const std::string& word) {
  if (word == "live") return drivers::Origin::live;
  if (word == "replay") return drivers::Origin::replay;
  if (word == "sim") return drivers::Origin::sim;
  if (word == "hil") return drivers::Origin::hil;
  return std::nullopt;
}

const char* origin_name(std::optional<drivers::Origin> origin) {
  if (!origin) return "nothing";
  switch (*origin) {
    case drivers::Origin::live:
      return "LIVE";
    case drivers::Origin::replay:
      return "REPLAY";
    case drivers::Origin::sim:
      return "SIM";
    case drivers::Origin::hil:
      return "HIL";
  }
  return "nothing";
}

namespace {

const char* link_name(LinkState link) {
  switch (link) {
    case LinkState::waiting:
      return "waiting";
    case LinkState::fresh:
      return "fresh";
    case LinkState::stale:
      return "stale";
    case LinkState::lost:
      return "lost";
  }
  return "waiting";
}

}  // namespace

std::string describe_link(const Listener& listener) {
  return fmt::format("map {} from {}", link_name(listener.link()), origin_name(listener.origin()));
}

std::string listen_line(const Listener& listener, const mapping::MapSnapshot* map) {
  const auto& counters = listener.counters();
  return fmt::format("{}, {} datagrams, {} lost, {} rejected, {} measured cells", describe_link(listener),
                     counters.datagrams, counters.lost, counters.rejected, map == nullptr ? 0 : map->measured_cells());
}

std::optional<std::vector<std::string>> announced_layers(const Listener& listener) {
  if (!listener.announce()) return std::nullopt;
  std::vector<std::string> names;
  for (const protocol::AnnouncedLayer& announced : listener.announce()->layers) {
    if (const auto layer = protocol::layer_from_wire(announced.layer))
      names.emplace_back(protocol::layer_format(*layer).name);
  }
  return names;
}

namespace {

/// The reasons that occurred.
nlohmann::ordered_json reasons_json(const ListenerCounters& counters) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < counters.rejected_by.size(); ++i)
    if (counters.rejected_by[i] > 0)
      json[std::string(protocol::reject_name(static_cast<protocol::Reject>(i)))] = counters.rejected_by[i];
  return json;
}

nlohmann::ordered_json client_json(const ClientCounters* client) {
  if (client == nullptr) return nullptr;
  const auto ms = [](const std::optional<Duration>& duration) -> nlohmann::ordered_json {
    if (!duration) return nullptr;
    return 1e-6 * static_cast<double>(duration->count());
  };
  return {{"subscribes", client->subscribes},
          {"nacks", client->nacks},
          {"nack_tiles", client->nack_tiles},
          {"pings", client->pings},
          {"pongs", client->pongs},
          {"round_trip_ms", ms(client->round_trip)},
          {"clock_offset_ms", ms(client->clock_offset)}};
}

}  // namespace

std::string listen_json(const Listener& listener, const mapping::MapSnapshot* map) {
  const auto& counters = listener.counters();
  nlohmann::ordered_json json{
      {"origin", origin_name(listener.origin())},
      {"link", link_name(listener.link())},
      {"ended", listener.ended()},
      {"health", listener.health()},
      {"frames_in", listener.frames_in()},
      {"frames_dropped", listener.frames_dropped()},
      {"points", nullptr},
      {"cells_measured", map == nullptr ? 0 : map->measured_cells()},
      {"latency_ms", {{"p50", 1e-3 * listener.latency_p50_us()}, {"p99", 1e-3 * listener.latency_p99_us()}}},
      {"datagrams", counters.datagrams},
      {"lost", counters.lost},
      {"rejected", counters.rejected},
      {"rejected_by", reasons_json(counters)},
      {"refused_origin", counters.refused_origin},
      {"client", client_json(listener.client())},
      {"tiles", counters.tiles}};
  for (const char* key : {"x_min_m", "y_min_m", "cell_m", "rows", "columns", "revision"}) json[key] = nullptr;
  if (map != nullptr) {
    json.update({{"x_min_m", map->window.min.x * map->cell_m},
                 {"y_min_m", map->window.min.y * map->cell_m},
                 {"cell_m", map->cell_m},
                 {"rows", map->window.rows},
                 {"columns", map->window.columns},
                 {"revision", map->revision}});
  }
  return json.dump(2);
}

}  // namespace scree::node
