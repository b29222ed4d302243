#include "config/loader.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "config/key_types.hpp"
#include "config/sensor_schema.hpp"
#include "config/settings_schema.hpp"
#include "config/source_schema.hpp"
#include "config/text_file.hpp"

namespace scree::config {

Result<Settings> parse_settings(std::string_view text, const std::string& name,
                                const std::vector<std::string>& assignments) {
  auto root = parse_yaml(text, name);
  if (!root) return Error{ErrorKind::bad_config, root.error().message};
  Settings settings;
  Given given;
  Faults faults;
  settings.sources.resize(spread_sources(*root, name, assignments, faults));
  if (!faults.empty()) return faults.to_error(ErrorKind::bad_config);
  const Schema<Settings> schema = with_sources(settings_schema(), settings.sources.size());
  const auto keys = bind(schema, settings);
  read_tree(*root, name, keys, given, faults);
  for (const auto& assignment : assignments) read_assignment(assignment, keys, given, faults);
  check_rules(schema, settings, name, given, faults);
  if (!faults.empty()) return faults.to_error(ErrorKind::bad_config);
  normalise(settings.pose.T_map_body);
  if (settings.sensor) normalise(settings.sensor->T_body_sensor);
  for (SourceSettings& source : settings.sources)
    if (source.sensor) normalise(source.sensor->T_body_sensor);
  return settings;
}

Result<Settings> load_settings(const std::optional<std::filesystem::path>& file,
                               const std::vector<std::string>& assignments) {
  if (!file) return parse_settings("", "(defaults)", assignments);
  const auto text = read_text_file(*file, "a configuration file");
  if (!text) return text.error();
  return parse_settings(*text, file->string(), assignments);
}

std::string dump_settings(const Settings& settings) {
  return dump(with_sources(settings_schema(), settings.sources.size()), settings);
}

Result<SensorConfig> effective_sensor(const SensorSettings& settings, const std::optional<SensorConfig>& recorded) {
  if (!settings.sensor) return recorded.value_or(SensorConfig{});
  if (settings.has_whole_sensor() || !recorded) return *settings.sensor;
  static const Schema<SensorConfig> schema = sensor_schema(false);
  SensorConfig sensor = *recorded;
  Given given;
  for (const auto& key : schema.keys) {
    const auto& names = settings.sensor_given;
    if (std::find(names.begin(), names.end(), key.name) == names.end()) continue;
    key.copy(*settings.sensor, sensor);
    given.emplace_back(key.name, Position{"configuration: sensor", 0, 0});
  }
  Faults faults;
  check_rules(schema, sensor, "configuration with the recording: sensor", given, faults);
  if (!faults.empty()) return faults.to_error(ErrorKind::bad_config);
  normalise(sensor.T_body_sensor);
  return sensor;
}

std::string settings_table() {
  Settings defaults;
  std::string table = "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const auto& key : settings_schema().keys) {
    const std::string value = key.write(defaults);
    std::string expected = key.expected;
    if (!key.applies_to.empty()) expected += " (" + key.applies_to + ")";
    table +=
        fmt::format("| `{}` | {} | {} | {} |\n", key.name, expected, value == "[]" ? "" : "`" + value + "`", key.doc);
  }
  table += fmt::format(
      "| `sources` | a list of at most {} maps | | Several sources at once: each has the keys of `source.` "
      "(`simulated_sensor` for its `sensor`) and a `sensor` of its own. |\n",
      kMaxSources);
  return table;
}

}  // namespace scree::config
