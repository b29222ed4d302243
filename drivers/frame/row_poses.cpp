#include "drivers/frame/row_poses.hpp"

namespace scree {

void RowPoses::compute(const RangeFrame& frame) {
  anchor_map_m = frame.T_map_body.back().translation_m.array().round();
  rows.resize(frame.T_map_body.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Pose T_map_sensor = frame.T_map_body[r] * frame.sensor->T_body_sensor;
    rows[r].rotation = T_map_sensor.rotation.toRotationMatrix().cast<float>();
    rows[r].origin_m = (T_map_sensor.translation_m - anchor_map_m).cast<float>();
  }
}

}  // namespace scree
