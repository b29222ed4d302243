#include "tests/bench/map/truth/drive.hpp"

#include <atomic>
#include <unistd.h>

#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {

GroundFile::GroundFile(const Ground& ground) {
  static std::atomic<int> number = 0;
  file_ = std::filesystem::temp_directory_path() /
          ("scree-map-bench-" + std::to_string(::getpid()) + "-" + std::to_string(number++) + ".tif");
  must(io::write_geotiff(file_, ground.nodes));
}

GroundFile::~GroundFile() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

drivers::SimulatorConfig drive_config(const GroundFile& ground, const std::string& sensor, std::uint64_t seed) {
  drivers::SimulatorConfig config;
  config.terrain = ground.path();
  config.sensor = sensor;
  config.trajectory = kWay;
  config.seed = seed;
  config.frame_period = kFramePeriod;
  return config;
}

drivers::Simulator simulator_over(const GroundFile& ground, const std::string& sensor, std::uint64_t seed) {
  return must(drivers::Simulator::make(drive_config(ground, sensor, seed)));
}

std::vector<std::shared_ptr<const RangeFrame>> render_all(const drivers::Simulator& simulator) {
  SerialExecutor serial;
  std::vector<std::shared_ptr<const RangeFrame>> frames;
  for (std::size_t i = 0; i < simulator.frame_count(); ++i)
    frames.push_back(simulator.range_frame(must(simulator.render(i, serial)), Duration{0}));
  return frames;
}

DrivenMaps map_drive(const std::vector<std::shared_ptr<const RangeFrame>>& frames, const mapping::MapConfig& config) {
  SerialExecutor serial;
  mapping::Mapper mapper(config, serial);
  WelfordFusion plain(config.cell_m, config.size_cells);
  for (const auto& frame : frames) {
    must(mapper.step(*frame));
    plain.add(*frame);
  }
  auto map = mapper.snapshot();
  return {map, plain.cut(map->window)};
}

}  // namespace scree::bench
