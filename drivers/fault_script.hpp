#pragma once
// What shall go wrong with a simulated device, and when: `scree simulate --faults FILE` (docs/simulator.md).

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"

namespace scree::drivers {

enum class FaultKind : std::uint8_t { unplug, stall, babble, corrupt, slow, wrong_geometry, freeze };
inline constexpr std::size_t kFaultKinds = 7;

struct Fault {
  Duration at{0};  ///< since the first reader came
  FaultKind kind = FaultKind::unplug;
  Duration lasts{0};         ///< unplug, slow, wrong_geometry, freeze; > 0
  double factor = 1.0;       ///< slow: a frame takes that many frame periods; > 0
  std::uint64_t frames = 0;  ///< corrupt; > 0
  int line = 0;              ///< of the script
};

/// As the script names it.
std::string_view to_string(FaultKind kind);
/// It is one of a USB endpoint, and means nothing on a socket.
inline bool needs_endpoint(FaultKind kind) {
  return kind == FaultKind::stall || kind == FaultKind::babble;
}

/// Lines `T_S ACTION [ARGS]`, `#` begins a comment, times never decrease. Errors: bad_data "FILE:LINE: expected …,
/// found …".
Result<std::vector<Fault>> parse_fault_script(std::string_view text, const std::string& file);
/// Errors: also no_input.
Result<std::vector<Fault>> load_fault_script(const std::filesystem::path& file);

}  // namespace scree::drivers
