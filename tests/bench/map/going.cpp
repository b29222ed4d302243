#include "tests/bench/map/going.hpp"

#include <algorithm>

#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {

EndlessDrive::EndlessDrive(const std::string& sensor) {
  const GroundFile file(must(make_ground({2.3, 0.05, 400})));
  drivers::SimulatorConfig config = drive_config(file, sensor, 1);
  const bool slow = sensor.starts_with("perceptron");  // half a second a scan
  config.trajectory = slow ? "line:0,0,0,1.2,0.2" : "line:0,0,0,1.2,1";
  step_ = config.frame_period = std::chrono::milliseconds(slow ? 500 : 100);
  frames_ = render_all(must(drivers::Simulator::make(config)));
}

RangeFrame EndlessDrive::next() {
  const std::size_t turn = frames_.size() - 1, phase = number_ % (2 * turn);
  RangeFrame frame = *frames_[phase <= turn ? phase : 2 * turn - phase];
  const Duration shift = static_cast<std::int64_t>(number_) * step_ - (frame.time - frames_.front()->time);
  frame.sequence = number_++;
  frame.time += shift;
  for (Time& time : frame.row_time) time += shift;
  return frame;
}

}  // namespace scree::bench
