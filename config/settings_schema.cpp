#include "config/settings_schema.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "config/key_types.hpp"
#include "config/mac_keys.hpp"
#include "config/sensor_schema.hpp"
#include "config/values.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::config {
namespace {

using mapping::MapConfig;
using mapping::VehicleConfig;

constexpr Bounds kMilliseconds{0, 3.6e6, false};

Schema<MapConfig> map_schema() {
  Schema<MapConfig> schema;
  schema.keys = {
      number<MapConfig>(
          "cell_m", [](MapConfig& m) -> double& { return m.cell_m; }, {0.005, 10, false}, "Side of a cell."),
      integer<MapConfig, int>(
          "size_cells", [](MapConfig& m) -> int& { return m.size_cells; }, {16, 2048, false},
          "Side of the square window that follows the robot."),
      integer<MapConfig, int>(
          "dimension_radius_cells", [](MapConfig& m) -> int& { return m.dimension_radius_cells; }, {3, 64, false},
          "D of a cell is that of the (2·radius + 1)² cells around it …"),
      integer<MapConfig, int>(
          "dimension_small_radius_cells", [](MapConfig& m) -> int& { return m.dimension_small_radius_cells; },
          {3, 64, false}, "… or of this many, where they are enough for the target."),
      number<MapConfig>(
          "dimension_sigma_target", [](MapConfig& m) -> double& { return m.dimension_sigma_target; }, {0, 1, false},
          "The small window's D is reported where its standard deviation is at most this."),
      number<MapConfig>(
          "reconstruct_reach_m", [](MapConfig& m) -> double& { return m.reconstruct_reach_m; }, {0, 100, false},
          "Unmeasured cells farther than this from measured ones stay unknown."),
      number<MapConfig>(
          "drop_margin_m", [](MapConfig& m) -> double& { return m.drop_margin_m; }, {0, 100, false},
          "possible_drop: rays passed this much below the expected ground."),
      number<MapConfig>(
          "outlier_sigmas", [](MapConfig& m) -> double& { return m.outlier_sigmas; }, {1, 1000, false},
          "A return that contradicts its cell by more is counted, not fused."),
      flag<MapConfig>(
          "align_frames", [](MapConfig& m) -> bool& { return m.align_frames; },
          "Lay every frame onto the map, and let the map follow the pose: for poses that drift."),
      integer<MapConfig, int>(
          "draws", [](MapConfig& m) -> int& { return m.draws; }, {2, 64, false},
          "Surfaces that the ground may be, behind standard deviation and risk."),
      integer<MapConfig, int>(
          "headings", [](MapConfig& m) -> int& { return m.headings; }, {1, 64, false},
          "Sectors of half a turn that the risk is told for."),
      integer<MapConfig, std::uint8_t>(
          "unmeasured_cost_floor", [](MapConfig& m) -> std::uint8_t& { return m.cost.unmeasured_floor; },
          {0, 252, false}, "Reconstructed ground is never cheaper."),
      number<MapConfig>(
          "lethal_risk", [](MapConfig& m) -> double& { return m.cost.lethal_risk; }, {0, 1, true},
          "A cell is lethal from this probability of violating a limit."),
      integer<MapConfig, std::uint64_t>(
          "seed", [](MapConfig& m) -> std::uint64_t& { return m.seed; }, {0, 9.2e18, false},
          "Of the reconstructed ground; the same seed, the same map.")};
  schema.rules.push_back(
      {{"dimension_radius_cells", "size_cells"}, [](const MapConfig& m) -> std::optional<Contradiction> {
         if (2 * m.dimension_radius_cells + 1 <= m.size_cells) return std::nullopt;
         return Contradiction{fmt::format("a window (2·radius + 1) within the map's {} cells", m.size_cells),
                              fmt::format("{} cells", 2 * m.dimension_radius_cells + 1)};
       }});
  schema.rules.push_back({{"dimension_small_radius_cells", "dimension_radius_cells"},
                          [](const MapConfig& m) -> std::optional<Contradiction> {
                            if (m.dimension_small_radius_cells <= m.dimension_radius_cells) return std::nullopt;
                            return Contradiction{
                                fmt::format("at most dimension_radius_cells = {}", m.dimension_radius_cells),
                                fmt::format("{}", m.dimension_small_radius_cells)};
                          }});
  return schema;
}

Schema<VehicleConfig> vehicle_schema() {
  const Bounds length{0, 100, true};
  const Bounds angle{0, 1.5, true};
  Schema<VehicleConfig> schema;
  schema.keys = {
      number<VehicleConfig>(
          "track_m", [](VehicleConfig& v) -> double& { return v.track_m; }, length,
          "Between the left and the right wheels."),
      number<VehicleConfig>(
          "wheelbase_m", [](VehicleConfig& v) -> double& { return v.wheelbase_m; }, length,
          "Between the front and the rear axle."),
      number<VehicleConfig>(
          "wheel_radius_m", [](VehicleConfig& v) -> double& { return v.wheel_radius_m; }, length, "Wheel radius."),
      number<VehicleConfig>(
          "clearance_m", [](VehicleConfig& v) -> double& { return v.clearance_m; }, length, "Under the belly."),
      number<VehicleConfig>(
          "max_pitch_rad", [](VehicleConfig& v) -> double& { return v.max_pitch_rad; }, angle,
          "Steeper ground along the vehicle is lethal."),
      number<VehicleConfig>(
          "max_roll_rad", [](VehicleConfig& v) -> double& { return v.max_roll_rad; }, angle,
          "Steeper ground across the vehicle is lethal."),
      number<VehicleConfig>(
          "max_step_m", [](VehicleConfig& v) -> double& { return v.max_step_m; }, length, "A higher step is lethal."),
      number<VehicleConfig>(
          "height_m", [](VehicleConfig& v) -> double& { return v.height_m; }, length,
          "What hangs this much above the ground does not touch the vehicle.")};
  return schema;
}

bool accept_address_or_empty(const std::string& text) {
  return text.empty() || is_ipv4(text);
}
bool accept_destination(const std::string& text) {
  return is_endpoint(text, 1);
}
bool accept_listen(const std::string& text) {
  return is_endpoint(text, 0) && !text.starts_with("0.0.0.0:");
}
bool accept_name(const std::string& text) {
  return !text.empty() && text.size() <= 31 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}
bool accept_stream_address_or_empty(const std::string& text) {
  return text.empty() || drivers::parse_stream_address(text, "source.address");
}
bool accept_any(const std::string&) {
  return true;
}

Schema<PoseSettings> pose_source_schema() {
  Schema<PoseSettings> schema;
  schema.keys.push_back(choice<PoseSettings, PoseSource>(
      "source", [](PoseSettings& p) -> PoseSource& { return p.source; },
      {{"recording", PoseSource::recording}, {"static", PoseSource::fixed}, {"udp", PoseSource::udp}},
      "recording: the poses that come with the frames; static: T_map_body below; udp: POSE_INPUT messages."));
  append(schema, "T_map_body.", Lens<PoseSettings, Pose>([](PoseSettings& p) -> Pose& { return p.T_map_body; }),
         pose_schema(false));
  schema.keys.push_back(text<PoseSettings>(
      "accept_from", [](PoseSettings& p) -> std::string& { return p.accept_from; }, "an IPv4 address or \"\"",
      accept_address_or_empty, "udp: the only address POSE_INPUT is taken from; empty = loopback."));
  schema.keys.push_back(integer<PoseSettings, int>(
      "max_age_ms", [](PoseSettings& p) -> int& { return p.max_age_ms; }, {1, 3.6e6, false},
      "udp: a frame whose pose is older maps nothing."));
  return schema;
}

/// Keys of "pose." that the mapper reads.
Schema<MapConfig> pose_sigma_schema() {
  Schema<MapConfig> schema;
  schema.keys = {number<MapConfig>(
                     "sigma_xy_m", [](MapConfig& m) -> double& { return m.pose_sigma_xy_m; }, {0, 100, false},
                     "Standard deviation of a pose's x and y where its source tells none."),
                 number<MapConfig>(
                     "sigma_z_m", [](MapConfig& m) -> double& { return m.pose_sigma_z_m; }, {0, 100, false},
                     "The same for its z."),
                 number<MapConfig>(
                     "sigma_attitude_rad", [](MapConfig& m) -> double& { return m.pose_sigma_attitude_rad; },
                     {0, 1, false}, "The same for its rotation about each axis.")};
  return schema;
}

Schema<PublishSettings> publish_schema() {
  using P = PublishSettings;
  Schema<P> schema;
  schema.keys = {
      text<P>(
          "destination", [](P& p) -> std::string& { return p.destination; }, "IPv4-ADDRESS:PORT", accept_destination,
          "Where map datagrams go."),
      text<P>(
          "listen", [](P& p) -> std::string& { return p.listen; }, "IPv4-ADDRESS:PORT of this machine (not 0.0.0.0; port 0 = any free one)",
          accept_listen, "Where the node hears its clients and pose sources."),
      choice<P, drivers::Origin>(
          "origin", [](P& p) -> drivers::Origin& { return p.origin; },
          {{"live", drivers::Origin::live}, {"sim", drivers::Origin::sim}, {"hil", drivers::Origin::hil}},
          "What the datagrams of `scree run` say; a replay always says REPLAY."),
      integer<P, int>(
          "refresh_ms", [](P& p) -> int& { return p.refresh_ms; }, {100, 3.6e6, false},
          "Every block is sent again in this time."),
      integer<P, int>(
          "cell_max_age_ms", [](P& p) -> int& { return p.cell_max_age_ms; }, kMilliseconds,
          "Receivers take older blocks as unknown; 0 = no limit."),
      integer<P, int>(
          "datagrams_per_s", [](P& p) -> int& { return p.datagrams_per_s; }, {100, 1e6, false},
          "Pacing of each destination."),
      integer<P, int>(
          "max_subscribers", [](P& p) -> int& { return p.max_subscribers; }, {0, 256, false},
          "Destinations that may subscribe at one time."),
      integer<P, int>(
          "multicast_ttl", [](P& p) -> int& { return p.multicast_ttl; }, {0, 255, false},
          "Routers that datagrams to a multicast destination pass, plus 1."),
      text<P>(
          "multicast_interface", [](P& p) -> std::string& { return p.multicast_interface; }, "an IPv4 address or \"\"",
          accept_address_or_empty,
          "Address of the interface for a multicast destination; empty = the kernel's choice."),
      mac_keys(),
      integer<P, std::uint32_t>(
          "stream_id", [](P& p) -> std::uint32_t& { return p.stream_id; },
          {0, std::numeric_limits<std::uint32_t>::max(), false}, "One map of one node."),
      text<P>(
          "frame_name", [](P& p) -> std::string& { return p.frame_name; }, "1 to 31 visible ASCII characters",
          accept_name, "Name of the map frame."),
      text<P>(
          "node_name", [](P& p) -> std::string& { return p.node_name; }, "1 to 31 visible ASCII characters",
          accept_name, "Name of the node.")};
  schema.rules.push_back({{"listen", "destination"}, [](const P& p) -> std::optional<Contradiction> {
                            if (p.listen != p.destination) return std::nullopt;
                            return Contradiction{"another address than publish.destination", p.listen};
                          }});
  return schema;
}

Schema<NodeSettings> node_schema() {
  using N = NodeSettings;
  Schema<N> schema;
  schema.keys = {integer<N, int>(
                     "threads", [](N& n) -> int& { return n.threads; }, {1, 64, false}, "Threads of the map stage."),
                 integer<N, int>(
                     "queue_frames", [](N& n) -> int& { return n.queue_frames; }, {1, 256, false},
                     "Replay: frames that wait between acquire and map."),
                 integer<N, int>(
                     "sensor_stale_ms", [](N& n) -> int& { return n.sensor_stale_ms; }, {1, 3.6e6, false},
                     "Live: no frame for this long sets the health bit sensor stale."),
                 integer<N, int>(
                     "sensor_lost_ms", [](N& n) -> int& { return n.sensor_lost_ms; }, {1, 3.6e6, false},
                     "Live: no frame for this long sets the health bit sensor lost.")};
  schema.rules.push_back({{"sensor_lost_ms", "sensor_stale_ms"}, [](const N& n) -> std::optional<Contradiction> {
                            if (n.sensor_stale_ms <= n.sensor_lost_ms) return std::nullopt;
                            return Contradiction{"sensor_stale_ms of at most sensor_lost_ms",
                                                 fmt::format("{} and {}", n.sensor_stale_ms, n.sensor_lost_ms)};
                          }});
  return schema;
}

Schema<SourceSettings> source_schema() {
  using S = SourceSettings;
  Schema<S> schema;
  schema.keys = {
      choice<S, SourceKind>(
          "kind", [](S& s) -> SourceKind& { return s.kind; },
          {{"none", SourceKind::none},
           {"recording", SourceKind::recording},
           {"simulated", SourceKind::simulated},
           {"stream", SourceKind::stream}},
          "What `scree run` acquires from."),
      text<S>(
          "path", [](S& s) -> std::string& { return s.path; }, "a path", accept_any,
          "recording: its directory, played in real time, newest frame wins."),
      flag<S>(
          "loop", [](S& s) -> bool& { return s.loop; }, "Start again at the end."),
      text<S>(
          "terrain", [](S& s) -> std::string& { return s.terrain; }, "a terrain", accept_any,
          "simulated: as `scree simulate --terrain`."),
      text<S>(
          "sensor", [](S& s) -> std::string& { return s.sensor; }, "a sensor", accept_any,
          "simulated: as `scree simulate --sensor`."),
      text<S>(
          "trajectory", [](S& s) -> std::string& { return s.trajectory; }, "a trajectory", accept_any,
          "simulated: as `scree simulate --trajectory`."),
      flag<S>(
          "noise", [](S& s) -> bool& { return s.noise; }, "simulated: nominal noise, or none."),
      integer<S, std::uint64_t>(
          "seed", [](S& s) -> std::uint64_t& { return s.seed; }, {0, 9.2e18, false},
          "simulated: of everything random."),
      text<S>(
          "address", [](S& s) -> std::string& { return s.address; }, "unix:PATH, tcp:HOST:PORT or \"\"",
          accept_stream_address_or_empty, "stream: where the device serves its frames; TCP on the loopback only."),
      integer<S, int>(
          "deadline_ms", [](S& s) -> int& { return s.deadline_ms; }, {100, 3.6e6, false},
          "stream: a device that says nothing good for this long is connected to again.")};
  schema.rules.push_back({{"address", "kind"}, [](const S& s) -> std::optional<Contradiction> {
                            if (s.kind != SourceKind::stream || !s.address.empty()) return std::nullopt;
                            return Contradiction{"source.address with source.kind stream", "no address"};
                          }});
  schema.rules.push_back({{"path", "kind"}, [](const S& s) -> std::optional<Contradiction> {
                            if (s.kind != SourceKind::recording || !s.path.empty()) return std::nullopt;
                            return Contradiction{"source.path with source.kind recording", "no path"};
                          }});
  schema.rules.push_back(
      {{"kind", "terrain", "sensor", "trajectory"}, [](const S& s) -> std::optional<Contradiction> {
         const bool whole = !s.terrain.empty() && !s.sensor.empty() && !s.trajectory.empty();
         if (s.kind != SourceKind::simulated || whole) return std::nullopt;
         return Contradiction{"terrain, sensor and trajectory with source.kind simulated", "not all of them"};
       }});
  return schema;
}

/// The keys of a sensor, which need not be given. Each one that is given is noted; the rules of a sensor hold only for
/// a whole one here (see effective_sensor).
void add_sensor(Schema<Settings>& schema) {
  const Lens<Settings, SensorConfig> lens = [](Settings& s) -> SensorConfig& {
    if (!s.sensor) s.sensor.emplace();
    return *s.sensor;
  };
  Schema<Settings> lifted;
  const Schema<SensorConfig> sensor = sensor_schema(false);
  append(lifted, "sensor.", lens, sensor);
  for (std::size_t i = 0; i < lifted.keys.size(); ++i) {
    Key<Settings>& key = lifted.keys[i];
    const std::string name = sensor.keys[i].name;
    key.read = [read = key.read, name](const YamlNode& node, Settings& s) {
      if (std::find(s.sensor_given.begin(), s.sensor_given.end(), name) == s.sensor_given.end())
        s.sensor_given.push_back(name);
      return read(node, s);
    };
    key.applies = [applies = sensor.keys[i].applies, name](const Settings& s) {
      if (s.has_whole_sensor()) return !applies || applies(*s.sensor);
      return std::find(s.sensor_given.begin(), s.sensor_given.end(), name) != s.sensor_given.end();
    };
    schema.keys.push_back(std::move(key));
  }
  for (auto& rule : lifted.rules) {
    rule.check = [check = rule.check](const Settings& s) { return s.has_whole_sensor() ? check(s) : std::nullopt; };
    schema.rules.push_back(std::move(rule));
  }
}

Schema<Settings> make_schema() {
  Schema<Settings> schema;
  append(schema, "map.", Lens<Settings, MapConfig>([](Settings& s) -> MapConfig& { return s.map; }), map_schema());
  append(schema, "vehicle.", Lens<Settings, VehicleConfig>([](Settings& s) -> VehicleConfig& { return s.map.vehicle; }),
         vehicle_schema());
  append(schema, "pose.", Lens<Settings, PoseSettings>([](Settings& s) -> PoseSettings& { return s.pose; }),
         pose_source_schema());
  append(schema, "pose.", Lens<Settings, MapConfig>([](Settings& s) -> MapConfig& { return s.map; }),
         pose_sigma_schema());
  append(schema, "publish.", Lens<Settings, PublishSettings>([](Settings& s) -> PublishSettings& { return s.publish; }),
         publish_schema());
  append(schema, "node.", Lens<Settings, NodeSettings>([](Settings& s) -> NodeSettings& { return s.node; }),
         node_schema());
  append(schema, "source.", Lens<Settings, SourceSettings>([](Settings& s) -> SourceSettings& { return s.source; }),
         source_schema());
  add_sensor(schema);
  schema.rules.push_back({{"map.size_cells", "map.cell_m", "vehicle.wheelbase_m", "vehicle.track_m"},
                          [](const Settings& s) -> std::optional<Contradiction> {
                            const double side_m = s.map.cell_m * s.map.size_cells;
                            const double vehicle_m = std::max(s.map.vehicle.wheelbase_m, s.map.vehicle.track_m);
                            if (side_m >= 2 * vehicle_m) return std::nullopt;
                            return Contradiction{
                                fmt::format("a map of at least two vehicle lengths ({} m)", 2 * vehicle_m),
                                fmt::format("{} m", side_m)};
                          }});
  return schema;
}

}  // namespace

bool Settings::has_whole_sensor() const {
  return std::find(sensor_given.begin(), sensor_given.end(), "projection") != sensor_given.end();
}

const Schema<Settings>& settings_schema() {
  static const Schema<Settings> schema = make_schema();
  return schema;
}

}  // namespace scree::config
