#pragma once
// Carries out a fault script on a served device.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/fault_script.hpp"
#include "drivers/frame_server.hpp"

namespace scree::node {

class FaultInjector {
 public:
  /// `other_geometry`: payload of a GEOMETRY that contradicts the device's frames.
  FaultInjector(std::vector<drivers::Fault> faults, Duration frame_period, std::vector<std::uint8_t> other_geometry)
      : faults_(std::move(faults)), frame_period_(frame_period), other_geometry_(std::move(other_geometry)) {}

  /// Begins what is due and ends what is over, `since` the first reader. What was begun, for the log.
  std::vector<drivers::Fault> advance(Duration since, drivers::FrameServer& server);
  /// The frame as it is to be sent now.
  drivers::ServedFrame spoil(drivers::ServedFrame frame, std::uint64_t sequence);

  /// How many faults of each kind have begun; frames that were spoilt.
  const std::array<std::uint64_t, drivers::kFaultKinds>& injected() const { return injected_; }
  std::uint64_t frames_corrupted() const { return frames_corrupted_; }
  std::uint64_t frames_of_wrong_geometry() const { return frames_of_wrong_geometry_; }

 private:
  void begin(const drivers::Fault& fault, drivers::FrameServer& server);

  std::vector<drivers::Fault> faults_;
  Duration frame_period_;
  std::vector<std::uint8_t> other_geometry_;
  std::size_t next_ = 0;
  Duration unplugged_until_{0}, frozen_until_{0}, slow_until_{0}, wrong_until_{0}, now_{0};
  double factor_ = 1.0;
  std::uint64_t to_corrupt_ = 0;
  std::array<std::uint64_t, drivers::kFaultKinds> injected_{};
  std::uint64_t frames_corrupted_ = 0, frames_of_wrong_geometry_ = 0;
};

}  // namespace scree::node
