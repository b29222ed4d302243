#include "node/layer_files.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <system_error>

#include "io/npy.hpp"

namespace scree::node {
namespace {

#ifdef SCREE_WITH_GDAL
constexpr bool kRasterSupport = true;
#else
constexpr bool kRasterSupport = false;
#endif

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

Status check_picture_path(const std::string& option, const std::filesystem::path& path) {
  if (path.extension() != ".png")
    return Error{ErrorKind::usage, fmt::format("{} {}: expected FILE.png", option, path.string())};
  if (!io::picture_support())
    return Error{ErrorKind::usage, fmt::format("{} {}: this build cannot write pictures", option, path.string())};
  return check_creatable(path);
}

Result<LayerFiles> LayerFiles::prepare(const std::string& option, const std::filesystem::path& path) {
  LayerFiles files;
  files.extension_ = path.extension().string();
  files.base_ = std::filesystem::path(path).replace_extension();
  const bool known = files.extension_ == ".tif" || files.extension_ == ".npy" || files.extension_ == ".png";
  if (!known || path.stem().empty())
    return Error{ErrorKind::usage, fmt::format("{} {}: expected BASE.tif, BASE.npy or BASE.png, found '{}'", option,
                                               path.string(), path.filename().string())};
  if (files.extension_ == ".tif" && !kRasterSupport)
    return Error{ErrorKind::usage, fmt::format("{} {}: this build cannot write .tif (no GDAL)", option, path.string())};
  if (files.extension_ == ".png" && !io::picture_support())
    return Error{ErrorKind::usage, fmt::format("{} {}: this build cannot write .png", option, path.string())};
  return files;
}

std::filesystem::path LayerFiles::file(const std::string& layer) const {
  return fmt::format("{}.{}{}", base_.string(), layer, extension_);
}

Status LayerFiles::write(const std::string& layer, const io::PicturePanel& panel, const io::Raster& place,
                         const io::PictureFrame& frame) const {
  const auto path = file(layer);
  if (extension_ == ".npy") return io::write_npy(path, panel.values);
  if (extension_ == ".png") return io::write_layer_picture(path, panel, frame);
  io::Raster raster = place;
  raster.height_m = panel.values;
  return io::write_geotiff(path, raster);
}

}  // namespace scree::node
