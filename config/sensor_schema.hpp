#pragma once
// The keys of one sensor: the same in `sensor:` of recording.yaml and of a configuration.

#include <string>
#include <utility>
#include <vector>

#include "config/schema.hpp"
#include "drivers/frame/sensor.hpp"

namespace scree::config {

/// With `required`, projection and T_body_sensor must be given: a recording that does not say how its sensor looks and
/// sits would put ground where there is none.
Schema<SensorConfig> sensor_schema(bool required);

/// `sensor.parameters`: what each projection has besides its kind.
Schema<ProjectionConfig> parameter_schema();

/// The names of the projections in files.
const std::vector<std::pair<std::string, ProjectionKind>>& projections();

}  // namespace scree::config
