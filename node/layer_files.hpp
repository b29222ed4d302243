#pragma once
// `BASE.EXT` of an option: one file a layer, BASE.layer.EXT.

#include <filesystem>
#include <string>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "io/picture.hpp"
#include "io/raster.hpp"

namespace scree::node {

/// Makes sure that `path` can be created, without leaving anything behind. Errors: cannot_create.
Status check_creatable(const std::filesystem::path& path);

/// Errors: usage (not .png, or a build without pictures), cannot_create. `option` is named in messages.
Status check_picture_path(const std::string& option, const std::filesystem::path& path);

class LayerFiles {
 public:
  /// `path` = BASE.EXT with EXT tif, npy or png. Errors: usage (another extension, or one that this build cannot
  /// write).
  static Result<LayerFiles> prepare(const std::string& option, const std::filesystem::path& path);

  std::filesystem::path file(const std::string& layer) const;  ///< BASE.layer.EXT
  const std::filesystem::path& base() const { return base_; }

  /// `place` says where the values belong: a GeoTIFF gets its georeference (its heights are not looked at), a picture
  /// the metres of `frame`. Errors: cannot_create, io.
  Status write(const std::string& layer, const io::PicturePanel& panel, const io::Raster& place,
               const io::PictureFrame& frame) const;

 private:
  std::filesystem::path base_;
  std::string extension_;
};

}  // namespace scree::node
