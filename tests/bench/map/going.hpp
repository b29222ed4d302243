#pragma once
// Frames without end from a short drive: forth and back, time always forwards.

#include <memory>
#include <string>
#include <vector>

#include "drivers/frame/range_frame.hpp"

namespace scree::bench {

/// `sensor` driven 1.2 m over rough ground, a frame every 0.1 m.
class EndlessDrive {
 public:
  explicit EndlessDrive(const std::string& sensor);
  /// The next frame, stamped 0.1 s after the last (later where a scan takes longer).
  RangeFrame next();

 private:
  std::vector<std::shared_ptr<const RangeFrame>> frames_;
  std::size_t number_ = 0;
  Duration step_;
};

}  // namespace scree::bench
