#include "config/source_schema.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <string_view>
#include <utility>

#include "config/key_types.hpp"
#include "config/sensor_schema.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::config {
namespace {

using S = SourceSettings;

bool accept_any(const std::string&) {
  return true;
}
bool accept_stream_address_or_empty(const std::string& text) {
  return text.empty() || drivers::parse_stream_address(text, "source.address");
}
/// It names a folder of a recording and stands in log lines.
bool accept_name_or_empty(const std::string& text) {
  return text.size() <= 31 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
         });
}
bool accept_usb_id_or_empty(const std::string& text) {
  return text.empty() || parse_usb_id(text).has_value();
}

Key<S> words(std::string name, Lens<S, std::string> lens, std::string expected, std::string doc,
             bool (*accept)(const std::string&) = accept_any) {
  return text<S>(std::move(name), std::move(lens), std::move(expected), accept, std::move(doc));
}

void add_played_keys(Schema<S>& schema) {
  schema.keys.push_back(words(
      "path", [](S& s) -> std::string& { return s.path; }, "a path",
      "recording: its directory, played in real time, newest frame wins."));
  schema.keys.push_back(flag<S>(
      "loop", [](S& s) -> bool& { return s.loop; }, "Start again at the end."));
  schema.keys.push_back(words(
      "terrain", [](S& s) -> std::string& { return s.terrain; }, "a terrain",
      "simulated: as `scree simulate --terrain`."));
  schema.keys.push_back(words(
      "sensor", [](S& s) -> std::string& { return s.simulated_sensor; }, "a sensor",
      "simulated: as `scree simulate --sensor`."));
  schema.keys.push_back(words(
      "trajectory", [](S& s) -> std::string& { return s.trajectory; }, "a trajectory",
      "simulated: as `scree simulate --trajectory`."));
  schema.keys.push_back(flag<S>(
      "noise", [](S& s) -> bool& { return s.noise; }, "simulated: nominal noise, or none."));
  schema.keys.push_back(integer<S, std::uint64_t>(
      "seed", [](S& s) -> std::uint64_t& { return s.seed; }, {0, 9.2e18, false}, "simulated: of everything random."));
}

void add_device_keys(Schema<S>& schema) {
  schema.keys.push_back(words(
      "address", [](S& s) -> std::string& { return s.address; }, "unix:PATH, tcp:HOST:PORT or \"\"",
      "stream: where the device serves its frames; TCP on the loopback only.", accept_stream_address_or_empty));
  schema.keys.push_back(words(
      "device", [](S& s) -> std::string& { return s.device; }, "the path of a video device",
      "v4l2: /dev/video0, or one of the links in /dev/v4l/by-id that outlive replugging."));
  schema.keys.push_back(words(
      "format", [](S& s) -> std::string& { return s.format; }, "a four-character code or \"\"",
      "v4l2: the pixel format; empty = the first of Z16, Y16 and Y12 that the device offers."));
  schema.keys.push_back(number<S>(
      "rate_hz", [](S& s) -> double& { return s.rate_hz; }, {0, 1000, false},
      "v4l2: frames a second to ask for; 0 = the device's own."));
  schema.keys.push_back(words(
      "usb_id", [](S& s) -> std::string& { return s.usb_id; }, "VVVV:PPPP in hexadecimal digits or \"\"",
      "usb: vendor and product; empty = those of docs/usb-protocol.md.", accept_usb_id_or_empty));
  schema.keys.push_back(words(
      "serial", [](S& s) -> std::string& { return s.serial; }, "a serial number",
      "usb: the scanner with this one; empty = the first that is found."));
  schema.keys.push_back(integer<S, int>(
      "deadline_ms", [](S& s) -> int& { return s.deadline_ms; }, {100, 3.6e6, false},
      "A device that says nothing good for this long is opened again; one whose driver does not even return is "
      "abandoned."));
}

/// `kind` with one of its keys empty.
Rule<S> needs(SourceKind kind, const char* kind_name, const char* key, std::string S::*member) {
  return {{key, "kind"}, [=](const S& s) -> std::optional<Contradiction> {
            if (s.kind != kind || !(s.*member).empty()) return std::nullopt;
            return Contradiction{fmt::format("{} with kind {}", key, kind_name), fmt::format("no {}", key)};
          }};
}

/// sources[N] of "sources[N].kind=usb".
std::optional<std::size_t> index_of(std::string_view assignment) {
  constexpr std::string_view kList = "sources[";
  if (!assignment.starts_with(kList)) return std::nullopt;
  assignment.remove_prefix(kList.size());
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(assignment.data(), assignment.data() + assignment.size(), index);
  if (status != std::errc{} || end == assignment.data() + assignment.size() || *end != ']') return std::nullopt;
  return index;
}

/// What a source of a kind needs of its sensor and of the poses.
std::optional<Contradiction> contradiction_of(const SourceSettings& source, const Settings& settings) {
  if (source.kind == SourceKind::simulated && !source.sensor_given.empty())
    return Contradiction{"no `sensor` with kind simulated, which has its own", "sensor." + source.sensor_given.front()};
  if (source.kind != SourceKind::v4l2) return std::nullopt;
  if (!source.has_whole_sensor() || source.sensor->projection.kind != ProjectionKind::pinhole)
    return Contradiction{"a sensor with projection pinhole and the camera's intrinsics with kind v4l2", "none"};
  if (settings.pose.source == PoseSource::recording)
    return Contradiction{"pose.source udp or static with kind v4l2, whose frames bring no pose", "recording"};
  return std::nullopt;
}

/// What holds between the sources, and between the list and `source:`.
void add_list_rules(Schema<Settings>& schema, std::size_t count) {
  schema.rules.push_back({{"source.kind", "sources[0].kind"}, [](const Settings& s) -> std::optional<Contradiction> {
                            if (s.source.kind == SourceKind::none) return std::nullopt;
                            return Contradiction{"either source or the list sources", "both"};
                          }});
  schema.rules.push_back(
      {{"sensor.projection", "sources[0].kind"}, [](const Settings& s) -> std::optional<Contradiction> {
         if (s.sensor_given.empty()) return std::nullopt;
         return Contradiction{"`sensor` inside each entry of sources", "one beside the list"};
       }});
  for (std::size_t i = 0; i < count; ++i) {
    schema.rules.push_back(
        {{fmt::format("sources[{}].kind", i)}, [i](const Settings& s) -> std::optional<Contradiction> {
           if (s.sources[i].kind != SourceKind::none) return std::nullopt;
           return Contradiction{"what the source is: stream, usb, v4l2, simulated or recording", "none"};
         }});
    schema.rules.push_back(
        {{fmt::format("sources[{}].kind", i), fmt::format("sources[{}].sensor.projection", i), "pose.source"},
         [i](const Settings& s) { return contradiction_of(s.sources[i], s); }});
    schema.rules.push_back(
        {{fmt::format("sources[{}].kind", i)}, [i](const Settings& s) -> std::optional<Contradiction> {
           if (s.sources[i].kind != SourceKind::recording || s.sources.size() == 1) return std::nullopt;
           return Contradiction{"live sources beside each other", "a recording, whose times are others"};
         }});
    schema.rules.push_back(
        {{fmt::format("sources[{}].name", i)}, [i](const Settings& s) -> std::optional<Contradiction> {
           for (std::size_t j = 0; j < i; ++j)
             if (s.sources[j].name_at(j) == s.sources[i].name_at(i))
               return Contradiction{"names that differ", fmt::format("'{}' again", s.sources[i].name_at(i))};
           return std::nullopt;
         }});
  }
}

}  // namespace

Rule<Settings> single_source_rule() {
  return {{"source.kind", "sensor.projection", "pose.source"},
          [](const Settings& s) { return s.sources.empty() ? contradiction_of(s.all_sources()[0], s) : std::nullopt; }};
}

bool SensorSettings::has_whole_sensor() const {
  return std::find(sensor_given.begin(), sensor_given.end(), "projection") != sensor_given.end();
}

std::string SourceSettings::name_at(std::size_t place) const {
  return name.empty() ? fmt::format("source{}", place) : name;
}

std::vector<SourceSettings> Settings::all_sources() const {
  if (!sources.empty()) return sources;
  SourceSettings one = source;
  static_cast<SensorSettings&>(one) = *this;
  return {one};
}

std::optional<UsbId> parse_usb_id(const std::string& text) {
  UsbId id;
  const auto hex = [](std::string_view digits, std::uint16_t& value) {
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return digits.size() == 4 && status == std::errc{} && end == digits.data() + digits.size();
  };
  if (text.size() != 9 || text[4] != ':' || !hex(std::string_view(text).substr(0, 4), id.vendor) ||
      !hex(std::string_view(text).substr(5), id.product))
    return std::nullopt;
  return id;
}

Schema<SourceSettings> source_schema() {
  Schema<S> schema;
  schema.keys.push_back(choice<S, SourceKind>(
      "kind", [](S& s) -> SourceKind& { return s.kind; },
      {{"none", SourceKind::none},
       {"recording", SourceKind::recording},
       {"simulated", SourceKind::simulated},
       {"stream", SourceKind::stream},
       {"usb", SourceKind::usb},
       {"v4l2", SourceKind::v4l2}},
      "What `scree run` acquires from."));
  schema.keys.push_back(words(
      "name", [](S& s) -> std::string& { return s.name; }, "up to 31 letters, digits, _ and -",
      "In logs, statistics and recordings; empty = sourceN, its place in the list.", accept_name_or_empty));
  add_played_keys(schema);
  add_device_keys(schema);
  schema.rules = {needs(SourceKind::stream, "stream", "address", &S::address),
                  needs(SourceKind::v4l2, "v4l2", "device", &S::device),
                  needs(SourceKind::recording, "recording", "path", &S::path),
                  {{"kind", "terrain", "sensor", "trajectory"}, [](const S& s) -> std::optional<Contradiction> {
                     const bool whole = !s.terrain.empty() && !s.simulated_sensor.empty() && !s.trajectory.empty();
                     if (s.kind != SourceKind::simulated || whole) return std::nullopt;
                     return Contradiction{"terrain, sensor and trajectory with kind simulated", "not all of them"};
                   }}};
  return schema;
}

Schema<SensorSettings> sensor_settings_schema() {
  using Owner = SensorSettings;
  const Lens<Owner, SensorConfig> lens = [](Owner& s) -> SensorConfig& {
    if (!s.sensor) s.sensor.emplace();
    return *s.sensor;
  };
  Schema<Owner> lifted;
  const Schema<SensorConfig> sensor = sensor_schema(false);
  append(lifted, "sensor.", lens, sensor);
  for (std::size_t i = 0; i < lifted.keys.size(); ++i) {
    Key<Owner>& key = lifted.keys[i];
    const std::string name = sensor.keys[i].name;
    key.read = [read = key.read, name](const YamlNode& node, Owner& s) {
      if (std::find(s.sensor_given.begin(), s.sensor_given.end(), name) == s.sensor_given.end())
        s.sensor_given.push_back(name);
      return read(node, s);
    };
    key.applies = [applies = sensor.keys[i].applies, name](const Owner& s) {
      if (s.has_whole_sensor()) return !applies || applies(*s.sensor);
      return std::find(s.sensor_given.begin(), s.sensor_given.end(), name) != s.sensor_given.end();
    };
  }
  for (auto& rule : lifted.rules)
    rule.check = [check = rule.check](const Owner& s) { return s.has_whole_sensor() ? check(s) : std::nullopt; };
  return lifted;
}

Schema<Settings> with_sources(const Schema<Settings>& schema, std::size_t count) {
  if (count == 0) return schema;
  Schema<SourceSettings> entry = source_schema();
  const auto renamed = [](std::string& name) {
    if (name == "sensor") name = "simulated_sensor";  // here `sensor` is a section of its own
  };
  for (auto& key : entry.keys) renamed(key.name);
  for (auto& rule : entry.rules) std::for_each(rule.keys.begin(), rule.keys.end(), renamed);
  append(entry, "", Lens<SourceSettings, SensorSettings>([](SourceSettings& s) -> SensorSettings& { return s; }),
         sensor_settings_schema());
  Schema<Settings> whole = schema;
  for (std::size_t i = 0; i < count; ++i)
    append(whole, fmt::format("sources[{}].", i),
           Lens<Settings, SourceSettings>([i](Settings& s) -> SourceSettings& { return s.sources.at(i); }), entry);
  add_list_rules(whole, count);
  return whole;
}

std::size_t spread_sources(YamlNode& root, const std::string& file, const std::vector<std::string>& assignments,
                           Faults& faults) {
  std::size_t count = 0;
  for (std::size_t i = 0; root.kind == YamlNode::Kind::map && i < root.keys.size(); ++i) {
    if (root.keys[i].scalar != "sources") continue;
    const YamlNode key = root.keys[i];
    const YamlNode list = root.items[i];
    const auto at = static_cast<std::ptrdiff_t>(i);
    root.keys.erase(root.keys.begin() + at);
    root.items.erase(root.items.begin() + at);
    if (list.kind != YamlNode::Kind::sequence && list.kind != YamlNode::Kind::null)
      faults.add({file, key.line, key.column}, "sources", "a list of sources", describe(list));
    for (const YamlNode& item : list.items) {
      YamlNode name = key;
      name.line = item.line;
      name.column = item.column;
      name.scalar = fmt::format("sources[{}]", count++);
      root.keys.push_back(name);
      root.items.push_back(item);
    }
    break;
  }
  for (const auto& assignment : assignments)
    if (const auto index = index_of(assignment); index && *index < kMaxSources) count = std::max(count, *index + 1);
  if (count > kMaxSources)
    faults.add({file, 1, 1}, "sources", fmt::format("at most {} sources", kMaxSources), fmt::format("{}", count));
  return count;
}

}  // namespace scree::config
