// The adapter of OpenCV: drawing only; what to draw where comes from picture_layout.

#include "io/picture.hpp"

#include <fmt/format.h>

#ifdef SCREE_WITH_PICTURES

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "io/drawing.hpp"
#include "io/opencv_file.hpp"
#include "io/picture_layout.hpp"

namespace scree::io {
namespace {

// Everything is drawn at twice the size and halved at the end: smooth lines and letters.
constexpr int kFine = 2;
constexpr int kPanel = 500 * kFine;  ///< longer side of a map
constexpr int kLeft = 74 * kFine;    ///< room for the y axis
constexpr int kRight = 112 * kFine;  ///< room for the colour bar
constexpr int kTop = 52 * kFine;
constexpr int kBottom = 62 * kFine;
constexpr int kCaption = 34 * kFine;
constexpr int kTickLength = 5 * kFine;
constexpr double kTextScale = 0.5 * kFine;
constexpr double kTitleScale = 0.62 * kFine;

const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kUnknown(236, 236, 236);
const cv::Scalar kHatch(206, 206, 206);
const cv::Scalar kRed(40, 40, 220);

/// A 256-entry table of blue, green, red.
cv::Mat colours(ColourMap map) {
  cv::Mat levels(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i)
    levels.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(map == ColourMap::cost ? 255 - i : i);
  cv::Mat table;
  const int name = map == ColourMap::terrain ? cv::COLORMAP_CIVIDIS
                   : map == ColourMap::cost  ? cv::COLORMAP_MAGMA
                                             : cv::COLORMAP_VIRIDIS;
  cv::applyColorMap(levels, table, name);
  return table;
}

cv::Vec3b colour_of(const cv::Mat& table, double value, double min, double max) {
  const double level = std::clamp((value - min) / (max - min), 0.0, 1.0);
  return table.at<cv::Vec3b>(0, static_cast<int>(std::lround(255 * level)));
}

/// `at` is the baseline's left end, centre or right end.
void write(cv::Mat& canvas, const std::string& text, cv::Point at, Align align, double scale, int thickness = kFine) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &baseline);
  if (align == Align::centre) at.x -= size.width / 2;
  if (align == Align::right) at.x -= size.width;
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, thickness, cv::LINE_AA);
}

/// Maps a panel's metres to its pixels.
struct View {
  cv::Rect box;
  double x_min_m, y_min_m, cell_m;
  int rows, columns;

  int x_px(double x_m) const {
    return box.x + static_cast<int>(std::lround((x_m - x_min_m) / (cell_m * columns) * box.width));
  }
  int y_px(double y_m) const {  // north is up
    return box.y + box.height - static_cast<int>(std::lround((y_m - y_min_m) / (cell_m * rows) * box.height));
  }
  double x_max_m() const { return x_min_m + cell_m * columns; }
  double y_max_m() const { return y_min_m + cell_m * rows; }
};

void draw_unknown(cv::Mat canvas) {
  canvas.setTo(kUnknown);
  for (int offset = -canvas.rows; offset < canvas.cols; offset += 9 * kFine)
    cv::line(canvas, {offset, canvas.rows}, {offset + canvas.rows, 0}, kHatch, kFine, cv::LINE_AA);
}

void draw_cells(cv::Mat& canvas, const View& view, const Grid<float>& values, const ColourScale& scale, double min,
                double max) {
  cv::Mat area = canvas(view.box);
  draw_unknown(area);
  const cv::Mat table = colours(scale.map);
  const Grid<float> light = scale.hillshade ? hillshade(values, view.cell_m) : Grid<float>();
  for (int y = 0; y < area.rows; ++y) {
    const int row = view.rows - 1 - static_cast<int>(static_cast<std::int64_t>(y) * view.rows / area.rows);
    for (int x = 0; x < area.cols; ++x) {
      const int column = static_cast<int>(static_cast<std::int64_t>(x) * view.columns / area.cols);
      const float value = values(row, column);
      if (!std::isfinite(value)) continue;
      cv::Vec3b colour = colour_of(table, static_cast<double>(value), min, max);
      if (scale.hillshade) {
        const double factor = 0.42 + 0.82 * static_cast<double>(light(row, column));  // level ground keeps its colour
        for (int i = 0; i < 3; ++i) colour[i] = cv::saturate_cast<std::uint8_t>(factor * colour[i]);
      }
      area.at<cv::Vec3b>(y, x) = colour;
    }
  }
}

void draw_axes(cv::Mat& canvas, const View& view) {
  const cv::Rect& box = view.box;
  cv::rectangle(canvas, box, kInk, kFine);
  for (const Tick& tick : ticks(view.x_min_m, view.x_max_m(), 7)) {
    const int x = view.x_px(tick.value);
    cv::line(canvas, {x, box.br().y}, {x, box.br().y + kTickLength}, kInk, kFine);
    write(canvas, tick.label, {x, box.br().y + 20 * kFine}, Align::centre, kTextScale);
  }
  for (const Tick& tick : ticks(view.y_min_m, view.y_max_m(), 7)) {
    const int y = view.y_px(tick.value);
    cv::line(canvas, {box.x - kTickLength, y}, {box.x, y}, kInk, kFine);
    write(canvas, tick.label, {box.x - 9 * kFine, y + 5 * kFine}, Align::right, kTextScale);
  }
  write(canvas, "x / m", {box.x + box.width / 2, box.br().y + 43 * kFine}, Align::centre, kTextScale);
  write(canvas, "y / m", {box.x - 9 * kFine, box.y - 9 * kFine}, Align::right, kTextScale);
}

void draw_colour_bar(cv::Mat& canvas, const View& view, const ColourScale& scale, double min, double max) {
  const cv::Rect bar(view.box.br().x + 16 * kFine, view.box.y, 18 * kFine, view.box.height);
  const cv::Mat table = colours(scale.map);
  for (int y = 0; y < bar.height; ++y) {
    const double level = 1.0 - static_cast<double>(y) / (bar.height - 1);
    canvas(cv::Rect(bar.x, bar.y + y, bar.width, 1)).setTo(cv::Scalar(colour_of(table, level, 0.0, 1.0)));
  }
  cv::rectangle(canvas, bar, kInk, kFine);
  for (const Tick& tick : ticks(min, max, 6)) {
    const int y = bar.y + bar.height - static_cast<int>(std::lround((tick.value - min) / (max - min) * bar.height));
    cv::line(canvas, {bar.br().x, y}, {bar.br().x + kTickLength, y}, kInk, kFine);
    write(canvas, tick.label, {bar.br().x + 9 * kFine, y + 5 * kFine}, Align::left, kTextScale);
  }
  const cv::Rect swatch(bar.x, bar.br().y + 12 * kFine, bar.width, 14 * kFine);
  draw_unknown(canvas(swatch));
  cv::rectangle(canvas, swatch, kInk, kFine);
  write(canvas, "unknown", {swatch.br().x + 5 * kFine, swatch.br().y - 2 * kFine}, Align::left, kTextScale);
}

/// A bar of a round length, about a quarter of the panel, on a white plate.
void draw_scale_bar(cv::Mat& canvas, const View& view) {
  const Tick length = round_length((view.x_max_m() - view.x_min_m) / 3.5);
  const int width = view.x_px(view.x_min_m + length.value) - view.box.x;
  const cv::Rect plate(view.box.x + 10 * kFine, view.box.br().y - 44 * kFine, width + 20 * kFine, 34 * kFine);
  cv::rectangle(canvas, plate, kPaper, cv::FILLED);
  cv::rectangle(canvas, plate, kInk, kFine / 2);
  const cv::Rect bar(plate.x + 10 * kFine, plate.br().y - 11 * kFine, width, 5 * kFine);
  cv::rectangle(canvas, bar, kInk, cv::FILLED);
  write(canvas, length.label + " m", {plate.x + plate.width / 2, plate.y + 17 * kFine}, Align::centre, kTextScale);
}

/// An arrow head in the direction of travel, white with a dark edge.
void draw_robot(cv::Mat& canvas, const View& view, const RobotMark& robot) {
  const cv::Point2d centre(view.x_px(robot.x_m), view.y_px(robot.y_m));
  if (!view.box.contains(cv::Point(centre))) return;
  const auto corner = [&](double angle_rad, double length) {
    const double a = robot.heading_rad + angle_rad;
    return cv::Point(centre + cv::Point2d(std::cos(a), -std::sin(a)) * length * kFine);
  };
  const std::vector<cv::Point> shape{corner(0.0, 13), corner(2.5, 11), corner(CV_PI, 4), corner(-2.5, 11)};
  cv::fillConvexPoly(canvas, std::vector<cv::Point>{shape[0], shape[1], shape[2]}, kPaper, cv::LINE_AA);
  cv::fillConvexPoly(canvas, std::vector<cv::Point>{shape[0], shape[2], shape[3]}, kPaper, cv::LINE_AA);
  cv::polylines(canvas, shape, true, kInk, 2 * kFine, cv::LINE_AA);
}

/// Red on white, so that it shows on every colour of the scales.
void draw_path(cv::Mat& canvas, const View& view, const PicturePath& path) {
  std::vector<cv::Point> points;
  for (const auto& [x_m, y_m] : path.points_m) points.emplace_back(view.x_px(x_m), view.y_px(y_m));
  if (points.empty()) return;
  cv::Mat clipped = canvas(view.box);
  for (cv::Point& point : points) point -= view.box.tl();
  cv::polylines(clipped, points, false, kPaper, 5 * kFine, cv::LINE_AA);
  cv::polylines(clipped, points, false, kRed, 2 * kFine, cv::LINE_AA);
  cv::circle(clipped, points.front(), 5 * kFine, kPaper, cv::FILLED, cv::LINE_AA);
  cv::circle(clipped, points.front(), 5 * kFine, kRed, 2 * kFine, cv::LINE_AA);
  cv::circle(clipped, points.back(), 5 * kFine, kRed, cv::FILLED, cv::LINE_AA);
}

void draw_panel(cv::Mat& canvas, const View& view, const PicturePanel& panel, const Grid<float>& values,
                const std::optional<RobotMark>& robot, const std::vector<PicturePath>& paths) {
  const auto limits = value_limits(values);
  const double min = panel.scale.min.value_or(limits.first);
  const double max = std::max(panel.scale.max.value_or(limits.second), min + 1e-9);
  draw_cells(canvas, view, values, panel.scale, min, max);
  draw_axes(canvas, view);
  draw_colour_bar(canvas, view, panel.scale, min, max);
  draw_scale_bar(canvas, view);
  for (const PicturePath& path : paths) draw_path(canvas, view, path);
  if (robot) draw_robot(canvas, view, *robot);
  write(canvas, ascii_text(panel.title), {view.box.x + view.box.width / 2, view.box.y - 24 * kFine}, Align::centre,
        kTitleScale);
}

cv::Mat draw(const std::vector<PicturePanel>& panels, const PictureFrame& frame, const std::optional<RobotMark>& robot,
             const std::string& caption, const std::vector<PicturePath>& paths) {
  std::vector<const Grid<float>*> grids;
  for (const auto& panel : panels) grids.push_back(&panel.values);
  const CellBlock block = known_block(grids);
  const int longer = std::max(block.rows, block.columns);
  const int factor = std::max(1, kPanel / longer);  // whole pixels a cell, where there is room for that
  const double px_per_cell = longer <= kPanel ? factor : static_cast<double>(kPanel) / longer;
  const cv::Size map(static_cast<int>(block.columns * px_per_cell), static_cast<int>(block.rows * px_per_cell));
  const int pitch = kLeft + map.width + kRight;
  cv::Mat canvas(kTop + map.height + kBottom + (caption.empty() ? 0 : kCaption),
                 pitch * static_cast<int>(panels.size()), CV_8UC3, kPaper);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const View view{{pitch * static_cast<int>(i) + kLeft, kTop, map.width, map.height},
                    frame.x_min_m + block.column * frame.cell_m,
                    frame.y_min_m + block.row * frame.cell_m,
                    frame.cell_m,
                    block.rows,
                    block.columns};
    draw_panel(canvas, view, panels[i], cut(panels[i].values, block), robot, paths);
  }
  write(canvas, ascii_text(caption), {kLeft, canvas.rows - 14 * kFine}, Align::left, kTextScale);
  cv::Mat picture;
  cv::resize(canvas, picture, {}, 1.0 / kFine, 1.0 / kFine, cv::INTER_AREA);
  return picture;
}

}  // namespace

bool picture_support() {
  return true;
}

Status write_map_picture(const std::filesystem::path& file, const std::vector<PicturePanel>& panels,
                         const PictureFrame& frame, const std::optional<RobotMark>& robot, const std::string& caption,
                         const std::vector<PicturePath>& paths) {
  for (const auto& panel : panels) {
    const bool same =
        panel.values.rows() == panels[0].values.rows() && panel.values.columns() == panels[0].values.columns();
    if (panel.values.empty() || !same)
      return Error{ErrorKind::usage, fmt::format("{}: expected panels of one shape, found {} × {} beside {} × {}",
                                                 file.string(), panel.values.rows(), panel.values.columns(),
                                                 panels[0].values.rows(), panels[0].values.columns())};
  }
  if (panels.empty()) return Error{ErrorKind::usage, fmt::format("{}: expected a panel, found none", file.string())};
  return write_painting(file, [&] { return draw(panels, frame, robot, caption, paths); });
}

}  // namespace scree::io

#else  // a build without pictures

namespace scree::io {

bool picture_support() {
  return false;
}

Status write_map_picture(const std::filesystem::path& file, const std::vector<PicturePanel>&, const PictureFrame&,
                         const std::optional<RobotMark>&, const std::string&, const std::vector<PicturePath>&) {
  return Error{ErrorKind::unavailable, fmt::format("{}: this build cannot write pictures", file.string())};
}

}  // namespace scree::io

#endif

namespace scree::io {

Status write_layer_picture(const std::filesystem::path& file, const PicturePanel& panel, const PictureFrame& frame) {
  return write_map_picture(file, {panel}, frame, std::nullopt, "");
}

}  // namespace scree::io
