#pragma once
// The keys of what the node acquires from: `source:` with `sensor:`, and each entry of the list `sources:`.

#include <string>
#include <vector>

#include "config/schema.hpp"
#include "config/settings.hpp"

namespace scree::config {

/// One source without its sensor.
Schema<SourceSettings> source_schema();

/// "sensor." with the keys of a sensor, which need not be given. Each one that is given is noted; the rules of a sensor
/// hold only for a whole one here (see effective_sensor).
Schema<SensorSettings> sensor_settings_schema();

/// What `source`, its `sensor` and `pose.source` must agree on.
Rule<Settings> single_source_rule();

/// The settings' schema for a configuration whose list `sources` has `count` entries: their keys are
/// "sources[0].kind", "sources[0].sensor.range_max_m" and so on.
Schema<Settings> with_sources(const Schema<Settings>& schema, std::size_t count);

/// `sources: [a, b]` becomes the sections sources[0] and sources[1] of `root`, which is how its keys are named. Returns
/// how many entries there are, those of `assignments` ("sources[1].kind=usb") included. A list that is none is a fault.
std::size_t spread_sources(YamlNode& root, const std::string& file, const std::vector<std::string>& assignments,
                           Faults& faults);

/// At most this many sources.
inline constexpr std::size_t kMaxSources = 8;

}  // namespace scree::config
