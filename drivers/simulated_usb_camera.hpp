#pragma once
// The requests of the camera function (UVC 1.1, 4.2 and 4.3): error code, probe and commit. There is one format, so
// that nothing can be negotiated: whatever the host proposes, the answer is the same.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/frame_server.hpp"

namespace scree::drivers::usb {

/// The eight bytes of a control transfer.
struct ControlRequest {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;  ///< IN: room that the host has; OUT: of the data behind it
};

/// Data of an IN request, empty for OUT; nothing = STALL, the device does not do this.
using ControlReply = std::optional<std::vector<std::uint8_t>>;

inline constexpr std::size_t kProbeBytes = 34;

/// Class requests to one of the two interfaces of the camera.
class CameraControl {
 public:
  explicit CameraControl(const ServedShape& shape);
  ControlReply answer(const ControlRequest& request, std::span<const std::uint8_t> data);
  const std::array<std::uint8_t, kProbeBytes>& probe() const { return probe_; }

 private:
  ControlReply answer_control(const ControlRequest& request);
  ControlReply answer_streaming(const ControlRequest& request, std::span<const std::uint8_t> data);
  ControlReply refuse(std::uint8_t error);

  std::array<std::uint8_t, kProbeBytes> probe_{};
  std::uint8_t error_ = 0;  ///< of the last refused request
};

}  // namespace scree::drivers::usb
