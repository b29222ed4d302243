#pragma once
// A frame as a source delivers it: raw counts turned into metres along each ray, nothing filtered yet.

#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/frame/projection.hpp"
#include "drivers/frame/sensor.hpp"

namespace scree {

struct RangeFrame {
  std::shared_ptr<const Projection> projection;
  std::shared_ptr<const SensorConfig> sensor;
  std::uint64_t sequence = 0;
  Time time;                     ///< of row 0
  MonotonicTime received;        ///< when the source delivered it
  Grid<float> range_m;           ///< along the ray; NaN = no return; modulo projection->ambiguity_m
  std::vector<Time> row_time;    ///< one per row
  std::vector<Pose> T_map_body;  ///< one per row, interpolated to row_time
};

}  // namespace scree
