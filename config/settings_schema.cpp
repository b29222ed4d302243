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
#include "config/source_schema.hpp"
#include "config/values.hpp"

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
  schema.keys = {text<P>(
                     "destination", [](P& p) -> std::string& { return p.destination; }, "IPv4-ADDRESS:PORT",
                     accept_destination, "Where map datagrams go."),
                 text<P>(
                     "listen", [](P& p) -> std::string& { return p.listen; },
                     "IPv4-ADDRESS:PORT of this machine (not 0.0.0.0; port 0 = any free one)", accept_listen,
                     "Where the node hears its clients and pose sources."),
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
                     "multicast_interface", [](P& p) -> std::string& { return p.multicast_interface; },
                     "an IPv4 address or \"\"", accept_address_or_empty,
                     "Address of the interface for a multicast destination; empty = the kernel's choice."),
                 mac_keys(),
                 integer<P, std::uint32_t>(
                     "stream_id", [](P& p) -> std::uint32_t& { return p.stream_id; },
                     {0, std::numeric_limits<std::uint32_t>::max(), false}, "One map of one node."),
                 text<P>(
                     "frame_name", [](P& p) -> std::string& { return p.frame_name; },
                     "1 to 31 visible ASCII characters", accept_name, "Name of the map frame."),
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
                     "Live: no frame for this long sets the health bit sensor lost."),
                 integer<N, int>(
                     "merge_ms", [](N& n) -> int& { return n.merge_ms; }, {0, 1000, false},
                     "Several live sources: a frame waits at most this long for an earlier one of another source.")};
  schema.rules.push_back({{"sensor_lost_ms", "sensor_stale_ms"}, [](const N& n) -> std::optional<Contradiction> {
                            if (n.sensor_stale_ms <= n.sensor_lost_ms) return std::nullopt;
                            return Contradiction{"sensor_stale_ms of at most sensor_lost_ms",
                                                 fmt::format("{} and {}", n.sensor_stale_ms, n.sensor_lost_ms)};
                          }});
  return schema;
}

Schema<RecordSettings> record_schema() {
  using R = RecordSettings;
  Schema<R> schema;
  schema.keys = {integer<R, int>(
                     "queue_frames", [](R& r) -> int& { return r.queue_frames; }, {1, 1024, false},
                     "`scree run --record`: mapped frames that wait to be written; more are dropped, counted."),
                 integer<R, int>(
                     "keep_free_mb", [](R& r) -> int& { return r.keep_free_mb; }, {0, 1e6, false},
                     "The recording ends before its disk has less than this left.")};
  return schema;
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
  append(schema, "record.", Lens<Settings, RecordSettings>([](Settings& s) -> RecordSettings& { return s.record; }),
         record_schema());
  append(schema, "source.", Lens<Settings, SourceSettings>([](Settings& s) -> SourceSettings& { return s.source; }),
         source_schema());
  append(schema, "", Lens<Settings, SensorSettings>([](Settings& s) -> SensorSettings& { return s; }),
         sensor_settings_schema());
  schema.rules.push_back(single_source_rule());
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

const Schema<Settings>& settings_schema() {
  static const Schema<Settings> schema = make_schema();
  return schema;
}

}  // namespace scree::config
