// The adapter of OpenCV for drawings: pixels only.

#include "io/drawing.hpp"

#include <fmt/format.h>

#ifdef SCREE_WITH_PICTURES

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "io/opencv_file.hpp"
#include "io/picture_layout.hpp"

namespace scree::io {
namespace {

// Painted at twice the size in sixteenths of a pixel, and halved at the end: smooth lines and letters.
constexpr int kFine = 2;
constexpr int kShift = 4;
constexpr double kTextScale = 0.5 * kFine;
const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kPaper(255, 255, 255);

cv::Scalar scalar(const Colour& colour) {
  return {static_cast<double>(colour.blue), static_cast<double>(colour.green), static_cast<double>(colour.red)};
}

int sixteenths(double px) {
  return static_cast<int>(std::lround(px * kFine * (1 << kShift)));
}

cv::Point point(const PixelPoint& p) {
  return {sixteenths(p.x_px), sixteenths(p.y_px)};
}

void paint(cv::Mat& canvas, const PixelPoint& from, const PixelPoint& to, const Stroke& stroke) {
  const int width = std::max(1, static_cast<int>(std::lround(stroke.width_px * kFine)));
  cv::line(canvas, point(from), point(to), scalar(stroke.colour), width, cv::LINE_AA, kShift);
}

/// Dashes run on through the corners.
void paint_dashes(cv::Mat& canvas, const Stroke& stroke) {
  constexpr double kDash = 8.0, kPeriod = 13.0;
  double along = 0.0;
  for (std::size_t i = 1; i < stroke.points.size(); ++i) {
    const PixelPoint a = stroke.points[i - 1], b = stroke.points[i];
    const double length = std::hypot(b.x_px - a.x_px, b.y_px - a.y_px);
    const auto at = [&](double s) {
      return PixelPoint{a.x_px + (b.x_px - a.x_px) * s / length, a.y_px + (b.y_px - a.y_px) * s / length};
    };
    for (double s = -std::fmod(along, kPeriod); s < length; s += kPeriod)
      if (s + kDash > 0.0) paint(canvas, at(std::max(s, 0.0)), at(std::min(s + kDash, length)), stroke);
    along += length;
  }
}

struct Painter {
  cv::Mat& canvas;

  void operator()(const Stroke& stroke) const {
    if (stroke.dashed) return paint_dashes(canvas, stroke);
    for (std::size_t i = 1; i < stroke.points.size(); ++i)
      paint(canvas, stroke.points[i - 1], stroke.points[i], stroke);
  }
  void operator()(const Area& area) const {
    std::vector<cv::Point> corners;
    for (const PixelPoint& p : area.corners) corners.push_back(point(p));
    cv::fillPoly(canvas, std::vector<std::vector<cv::Point>>{corners}, scalar(area.colour), cv::LINE_AA, kShift);
  }
  void operator()(const Disc& disc) const {
    const int radius = sixteenths(disc.radius_px);
    cv::circle(canvas, point(disc.centre), radius, disc.filled ? scalar(disc.colour) : kPaper, cv::FILLED, cv::LINE_AA,
               kShift);
    if (!disc.filled)
      cv::circle(canvas, point(disc.centre), radius, scalar(disc.colour), kFine + kFine / 2, cv::LINE_AA, kShift);
  }
  void operator()(const Label& label) const {
    const std::string text = ascii_text(label.text);
    const double scale = kTextScale * label.size;
    int baseline = 0;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, kFine, &baseline);
    cv::Point at(static_cast<int>(std::lround(label.at.x_px * kFine)),
                 static_cast<int>(std::lround(label.at.y_px * kFine)));
    if (label.align == Align::centre) at.x -= size.width / 2;
    if (label.align == Align::right) at.x -= size.width;
    cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, kFine, cv::LINE_AA);
  }
};

}  // namespace

Status write_drawing(const std::filesystem::path& file, const Drawing& drawing) {
  return write_painting(file, [&drawing] {
    cv::Mat canvas(drawing.height_px * kFine, drawing.width_px * kFine, CV_8UC3, kPaper);
    for (const Shape& shape : drawing.shapes) std::visit(Painter{canvas}, shape);
    cv::Mat picture;
    cv::resize(canvas, picture, {}, 1.0 / kFine, 1.0 / kFine, cv::INTER_AREA);
    return picture;
  });
}

}  // namespace scree::io

#else  // a build without pictures

namespace scree::io {

Status write_drawing(const std::filesystem::path& file, const Drawing&) {
  return Error{ErrorKind::unavailable, fmt::format("{}: this build cannot write pictures", file.string())};
}

}  // namespace scree::io

#endif
