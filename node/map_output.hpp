#pragma once
// `--map-out BASE.EXT` and `--snapshot FILE.png`: the last map as files.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "mapping/snapshot.hpp"
#include "node/layer_files.hpp"
#include "node/statistics.hpp"

namespace scree::node {

/// Where a map is written to, checked before the long work starts.
class MapOutput {
 public:
  /// `path` = BASE.EXT with EXT tif, npy or png. Makes sure that a file can be created there. Errors: usage (another
  /// extension, or one that this build cannot write), cannot_create.
  static Result<MapOutput> prepare(const std::filesystem::path& path);

  /// BASE.cost.EXT, BASE.elevation.EXT, … (lower case layer names; NaN = unknown) and BASE.json: cell_m, x_min_m,
  /// y_min_m, rows, columns and `statistics_json`'s members.
  /// `only`: the layers to write, for a map that came without the others.
  Status write(const mapping::MapSnapshot& map, const std::string& statistics_json,
               const std::optional<std::vector<std::string>>& only = std::nullopt) const;

 private:
  explicit MapOutput(LayerFiles files) : files_(std::move(files)) {}

  LayerFiles files_;
};

enum class RobotPlace { known, unknown };  ///< unknown: a received map, whose T_map_body says nothing

/// The picture of a map: elevation, D and cost side by side. `source` says where it comes from ("REPLAY", a path).
Status write_snapshot_picture(const std::filesystem::path& path, const mapping::MapSnapshot& map,
                              const std::string& source, RobotPlace place);

}  // namespace scree::node
