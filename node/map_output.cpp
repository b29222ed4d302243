#include "node/map_output.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/picture.hpp"
#include "io/raster.hpp"
#include "node/map_layers.hpp"

namespace scree::node {

Result<MapOutput> MapOutput::prepare(const std::filesystem::path& path) {
  auto files = LayerFiles::prepare("--map-out", path);
  if (!files) return files.error();
  if (const auto possible = check_creatable(files->base().string() + ".json"); !possible) return possible.error();
  return MapOutput(*std::move(files));
}

Status MapOutput::write(const mapping::MapSnapshot& map, const std::string& statistics_json,
                        const std::optional<std::vector<std::string>>& only) const {
  const double x_min_m = map.window.min.x * map.cell_m, y_min_m = map.window.min.y * map.cell_m;
  for (const MapLayer& layer : map_layers(map)) {
    if (only && std::find(only->begin(), only->end(), layer.name) == only->end()) continue;
    const io::Raster place{{}, x_min_m, y_min_m, map.cell_m, map.cell_m, false};
    const io::PictureFrame frame{x_min_m, y_min_m, map.cell_m};
    if (auto written = files_.write(layer.name, {layer.title, layer.values, layer.scale}, place, frame); !written)
      return written;
  }
  nlohmann::ordered_json json{{"cell_m", map.cell_m},
                              {"x_min_m", x_min_m},
                              {"y_min_m", y_min_m},
                              {"rows", map.window.rows},
                              {"columns", map.window.columns}};
  json.update(nlohmann::ordered_json::parse(statistics_json));
  const std::string file = files_.base().string() + ".json";
  std::ofstream stream(file, std::ios::binary);
  if (!stream) return Error{ErrorKind::cannot_create, fmt::format("{}: {}", file, std::strerror(errno))};
  stream << json.dump(2) << '\n';
  stream.close();
  if (!stream) return Error{ErrorKind::io, fmt::format("{}: writing failed", file)};
  return {};
}

Status write_snapshot_picture(const std::filesystem::path& path, const mapping::MapSnapshot& map,
                              const std::string& source, RobotPlace place) {
  const auto layers = map_layers(map);
  std::vector<io::PicturePanel> panels;
  for (const char* name : {"elevation", "dimension", "cost"}) {
    for (const MapLayer& layer : layers) {
      if (layer.name == name) panels.push_back({layer.title, layer.values, layer.scale});
    }
  }
  const Eigen::Vector3d robot_m = map.T_map_body.translation_m;
  const Eigen::Vector3d ahead = map.T_map_body.rotation * Eigen::Vector3d::UnitX();
  const io::PictureFrame frame{map.window.min.x * map.cell_m, map.window.min.y * map.cell_m, map.cell_m};
  std::optional<io::RobotMark> robot;
  if (place == RobotPlace::known) robot = {robot_m.x(), robot_m.y(), std::atan2(ahead.y(), ahead.x())};
  const std::string caption = fmt::format("{}   {:.4g} m cells, {} × {}, {} measured   revision {}", source, map.cell_m,
                                          map.window.columns, map.window.rows, map.measured_cells(), map.revision);
  return io::write_map_picture(path, panels, frame, robot, caption);
}

}  // namespace scree::node
