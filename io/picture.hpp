#pragma once
// Pictures of maps: panels side by side with axes in metres, colour bars, a scale bar and the robot. PNG, through
// OpenCV.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::io {

/// False in a build without SCREE_WITH_PICTURES: everything here then fails with `unavailable`.
bool picture_support();

enum class ColourMap {
  viridis,  ///< perceptually uniform, for any quantity
  terrain,  ///< cividis: uniform and calm, made for hill shading
  cost,     ///< green to red, lethal nearly black
};

struct ColourScale {
  ColourMap map = ColourMap::viridis;
  std::optional<double> min;  ///< nothing: the 1 % quantile of the values
  std::optional<double> max;  ///< nothing: the 99 % quantile
  bool hillshade = false;     ///< the values are heights in metres: shade them, light from the north-west
};

struct PicturePanel {
  std::string title;   ///< with the unit
  Grid<float> values;  ///< row 0 at the smallest y; NaN = unknown, drawn hatched
  ColourScale scale;
};

/// The place of the grids: outer corner of cell (0, 0) and the cell's side.
struct PictureFrame {
  double x_min_m = 0.0;
  double y_min_m = 0.0;
  double cell_m = 1.0;
};

struct RobotMark {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;  ///< counter-clockwise from x
};

/// A way over the ground, drawn with its beginning as a ring and its end as a disc.
struct PicturePath {
  std::vector<std::array<double, 2>> points_m;  ///< x, y
};

/// Panels of the same shape side by side, north (+y) up, `caption` below, the robot and every path on each panel.
/// Errors: cannot_create, usage (no panel or panels of different shapes), unavailable.
Status write_map_picture(const std::filesystem::path& file, const std::vector<PicturePanel>& panels,
                         const PictureFrame& frame, const std::optional<RobotMark>& robot, const std::string& caption,
                         const std::vector<PicturePath>& paths = {});

/// One panel.
Status write_layer_picture(const std::filesystem::path& file, const PicturePanel& panel, const PictureFrame& frame);

}  // namespace scree::io
