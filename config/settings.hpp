#pragma once
// Everything a user can set, typed. The YAML keys are the member names (docs/configuration.md); the loader checks them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "drivers/frame/sensor.hpp"
#include "drivers/source.hpp"
#include "mapping/mapper.hpp"

namespace scree::config {

enum class PoseSource : std::uint8_t { recording, fixed, udp };  ///< YAML: recording | static | udp

struct PoseSettings {
  PoseSource source = PoseSource::recording;
  Pose T_map_body;          ///< for `static`
  std::string accept_from;  ///< for `udp`: the only address POSE_INPUT is taken from ("127.0.0.1"); empty = loopback
  int max_age_ms = 200;     ///< for `udp`: an older pose maps nothing
};

/// A key of the datagrams' MAC. Its bytes are shown nowhere: not in messages, not in a dump, not in its hash.
struct KeySettings {
  std::uint16_t id = 0;                  ///< 1 … 65535
  std::array<std::uint8_t, 32> bytes{};  ///< as given, or read from `file`
  std::string file;                      ///< empty = given as hex
};

struct PublishSettings {
  std::string destination = "127.0.0.1:47800";
  std::string listen = "127.0.0.1:47801";          ///< port 0 = any free one, printed
  drivers::Origin origin = drivers::Origin::live;  ///< live | sim | hil; replays always say REPLAY
  int refresh_ms = 1000;
  int cell_max_age_ms = 0;     ///< 0 = no limit
  int datagrams_per_s = 3000;  ///< pacing of each destination
  int max_subscribers = 16;
  int multicast_ttl = 1;
  std::string multicast_interface;  ///< address of the interface that a multicast destination is sent by; empty = the
                                    ///< kernel's choice
  std::vector<KeySettings> keys;    ///< at most two; the first signs
  std::uint32_t stream_id = 1;
  std::string frame_name = "map";
  std::string node_name = "scree";
};

struct NodeSettings {
  int threads = 1;            ///< threads of the map stage
  int queue_frames = 4;       ///< replay: bounded blocking queue between acquire and map
  int sensor_stale_ms = 500;  ///< live: no frame for this long sets the health bit "sensor stale"
  int sensor_lost_ms = 2000;  ///< live: the same for "sensor lost"
  int merge_ms = 100;         ///< several live sources: a frame waits at most this long for an earlier one of another
};

enum class SourceKind : std::uint8_t { none, recording, simulated, stream, usb, v4l2 };

/// What is known of a sensor beyond what its source says.
struct SensorSettings {
  /// Values of the `sensor.*` keys that were given, which `sensor_given` names ("range_max_m"). With the key
  /// "projection" among them this is a whole sensor and replaces what the source says; without, each given key
  /// overrides the source's. See effective_sensor.
  std::optional<SensorConfig> sensor;
  std::vector<std::string> sensor_given;

  bool has_whole_sensor() const;
};

struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
};
/// "1209:0001"; none for anything else.
std::optional<UsbId> parse_usb_id(const std::string& text);

/// One of the sources that `scree run` acquires from.
struct SourceSettings : SensorSettings {
  SourceKind kind = SourceKind::none;
  std::string name;  ///< empty = name_at
  std::string path;  ///< recording: directory, played in real time, newest wins
  bool loop = false;
  std::string terrain;           ///< simulated: the grammars of `scree simulate`
  std::string simulated_sensor;  ///< YAML: source.sensor, sources[].simulated_sensor
  std::string trajectory;
  bool noise = true;
  std::uint64_t seed = 1;
  std::string address;     ///< stream: unix:PATH or tcp:HOST:PORT
  std::string device;      ///< v4l2: /dev/video0
  std::string format;      ///< v4l2: four-character code; empty = what fits
  double rate_hz = 0;      ///< v4l2: 0 = the device's own
  std::string usb_id;      ///< usb: "VVVV:PPPP"; empty = the protocol's
  std::string serial;      ///< usb: empty = any
  int deadline_ms = 2000;  ///< a device that says nothing good for this long is opened again

  /// Its name, or "sourceN" of its place in the list.
  std::string name_at(std::size_t place) const;
};

/// Live recording (`scree run --record`).
struct RecordSettings {
  int queue_frames = 16;   ///< mapped frames that wait to be written; more are dropped, counted
  int keep_free_mb = 256;  ///< the recording ends before the disk has less than this left
};

struct Settings : SensorSettings {  ///< its own sensor is that of `source`, or of a replay
  mapping::MapConfig map;           ///< vehicle.* goes to map.vehicle
  PoseSettings pose;
  PublishSettings publish;
  NodeSettings node;
  RecordSettings record;
  SourceSettings source;                ///< of a node with one
  std::vector<SourceSettings> sources;  ///< of a node with several; empty = `source`

  /// `sources`, or `source` with the sensor beside it.
  std::vector<SourceSettings> all_sources() const;
};

}  // namespace scree::config
