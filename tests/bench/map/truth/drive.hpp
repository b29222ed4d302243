#pragma once
// A simulated drive over known ground, fused by the mapper and, from the same frames, by the plainest of fusions.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/simulator.hpp"
#include "mapping/mapper.hpp"
#include "tests/bench/map/truth/ground.hpp"
#include "tests/bench/map/truth/welford.hpp"

namespace scree::bench {

/// 7 m along y = 0 at 1 m/s towards the ditch, a frame every 0.6 s, whatever the sensor could do: 12 frames.
inline constexpr const char* kWay = "line:-3.5,0,0,7,1";
inline constexpr Duration kFramePeriod = std::chrono::milliseconds(600);

/// The ground's nodes as a raster in a temporary folder for as long as this lives: the simulator reads files.
class GroundFile {
 public:
  explicit GroundFile(const Ground& ground);
  ~GroundFile();
  GroundFile(const GroundFile&) = delete;
  GroundFile& operator=(const GroundFile&) = delete;
  std::string path() const { return file_.string(); }

 private:
  std::filesystem::path file_;
};

/// The configuration of `sensor` over the ground, nominal noise, exact poses.
drivers::SimulatorConfig drive_config(const GroundFile& ground, const std::string& sensor, std::uint64_t seed);

/// A simulator of it.
drivers::Simulator simulator_over(const GroundFile& ground, const std::string& sensor, std::uint64_t seed);

/// All frames of a drive as the sources would deliver them.
std::vector<std::shared_ptr<const RangeFrame>> render_all(const drivers::Simulator& simulator);

/// Both maps after the last frame. The plain one has its own conversion, so that neither helps the other.
struct DrivenMaps {
  std::shared_ptr<const mapping::MapSnapshot> map;
  WelfordMap plain;
};
DrivenMaps map_drive(const std::vector<std::shared_ptr<const RangeFrame>>& frames, const mapping::MapConfig& config);

}  // namespace scree::bench
