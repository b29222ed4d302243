#include "node/map_output.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/npy.hpp"
#include "io/picture.hpp"
#include "io/raster.hpp"
#include "node/map_layers.hpp"

namespace scree::node {
namespace {

#ifdef SCREE_WITH_GDAL
constexpr bool kRasterSupport = true;
#else
constexpr bool kRasterSupport = false;
#endif

Status write_layer(const std::filesystem::path& file, const std::string& extension, const MapLayer& layer,
                   const mapping::MapSnapshot& map) {
  const double x_min_m = map.window.min.x * map.cell_m;
  const double y_min_m = map.window.min.y * map.cell_m;
  if (extension == ".npy") return io::write_npy(file, layer.values);
  if (extension == ".tif")
    return io::write_geotiff(file, {layer.values, x_min_m, y_min_m, map.cell_m, map.cell_m, false});
  return io::write_layer_picture(file, {layer.title, layer.values, layer.scale}, {x_min_m, y_min_m, map.cell_m});
}

}  // namespace

Status check_creatable(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool existed = std::filesystem::exists(path, ignored);
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr)
    return Error{ErrorKind::cannot_create, fmt::format("{}: expected a place where a file can be written, found: {}",
                                                       path.string(), std::strerror(errno))};
  std::fclose(file);
  if (!existed) std::filesystem::remove(path, ignored);
  return {};
}

Result<MapOutput> MapOutput::prepare(const std::filesystem::path& path) {
  MapOutput output;
  output.extension_ = path.extension().string();
  output.base_ = std::filesystem::path(path).replace_extension();
  const bool known = output.extension_ == ".tif" || output.extension_ == ".npy" || output.extension_ == ".png";
  if (!known || path.stem().empty())
    return Error{ErrorKind::usage, fmt::format("--map-out {}: expected BASE.tif, BASE.npy or BASE.png, found '{}'",
                                               path.string(), path.filename().string())};
  if (output.extension_ == ".tif" && !kRasterSupport)
    return Error{ErrorKind::usage, fmt::format("--map-out {}: this build cannot write .tif (no GDAL)", path.string())};
  if (output.extension_ == ".png" && !io::picture_support())
    return Error{ErrorKind::usage, fmt::format("--map-out {}: this build cannot write .png", path.string())};
  if (const auto possible = check_creatable(output.base_.string() + ".json"); !possible) return possible.error();
  return output;
}

Status MapOutput::write(const mapping::MapSnapshot& map, const std::string& statistics_json,
                        const std::optional<std::vector<std::string>>& only) const {
  for (const MapLayer& layer : map_layers(map)) {
    if (only && std::find(only->begin(), only->end(), layer.name) == only->end()) continue;
    const auto file = fmt::format("{}.{}{}", base_.string(), layer.name, extension_);
    if (auto written = write_layer(file, extension_, layer, map); !written) return written;
  }
  nlohmann::ordered_json json{{"cell_m", map.cell_m},
                              {"x_min_m", map.window.min.x * map.cell_m},
                              {"y_min_m", map.window.min.y * map.cell_m},
                              {"rows", map.window.rows},
                              {"columns", map.window.columns}};
  json.update(nlohmann::ordered_json::parse(statistics_json));
  const std::string file = base_.string() + ".json";
  std::ofstream stream(file, std::ios::binary);
  if (!stream) return Error{ErrorKind::cannot_create, fmt::format("{}: {}", file, std::strerror(errno))};
  stream << json.dump(2) << '\n';
  stream.close();
  if (!stream) return Error{ErrorKind::io, fmt::format("{}: writing failed", file)};
  return {};
}

Status check_picture_path(const std::filesystem::path& path) {
  if (path.extension() != ".png")
    return Error{ErrorKind::usage, fmt::format("--snapshot {}: expected FILE.png", path.string())};
  if (!io::picture_support())
    return Error{ErrorKind::usage, fmt::format("--snapshot {}: this build cannot write pictures", path.string())};
  return check_creatable(path);
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
