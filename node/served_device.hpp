#pragma once
// `scree simulate --serve`: the simulated scanner as a live device, on a robot that follows its trajectory or is
// driven.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/simulator.hpp"
#include "mapping/vehicle.hpp"

namespace scree::node {

struct ServeOptions {
  std::string address;                  ///< of the frame stream
  std::optional<std::string> drive;     ///< where drive commands are taken; none = along the trajectory
  std::vector<std::string> pose_out;    ///< where the odometry's poses go, 50 times a second
  std::optional<std::string> track;     ///< file of true poses
  std::optional<Duration> duration;     ///< of the drive, at most
  std::optional<std::uint64_t> frames;  ///< at most
  mapping::VehicleConfig vehicle;       ///< whose limits are judged on the true ground
  std::optional<std::string> faults;    ///< script of what goes wrong
  std::uint32_t stream_id = 1;          ///< of pose_out
};

/// A robot and its scanner in real time. Single-threaded: rendering goes on in pieces between which everything else is
/// served.
class ServedDevice {
 public:
  /// Opens every address and file. Errors: usage, unavailable, cannot_create; no_input, bad_data
  /// (the fault script).
  static Result<std::unique_ptr<ServedDevice>> open(drivers::Simulator simulator, const std::string& sensor,
                                                    ServeOptions options);
  ~ServedDevice();
  ServedDevice(const ServedDevice&) = delete;
  ServedDevice& operator=(const ServedDevice&) = delete;

  /// A trajectory begins with the first reader and ends after its last frame; a driven robot is there from the start
  /// and stays until SIGINT, SIGTERM or the duration. Errors: io (the track), and those of rendering.
  Status run();

  /// After run(): one JSON object (docs/simulator.md).
  std::string report() const;

 private:
  struct State;
  explicit ServedDevice(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
