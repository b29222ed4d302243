#pragma once
// Simple pictures as data: what a layout decides and a test can read, before a library puts it into pixels.

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/result.hpp"

namespace scree::io {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// From the upper left corner of the picture.
struct PixelPoint {
  double x_px = 0.0, y_px = 0.0;
};

struct Stroke {
  std::vector<PixelPoint> points;
  Colour colour;
  double width_px = 1.0;
  bool dashed = false;
};

/// A filled polygon.
struct Area {
  std::vector<PixelPoint> corners;
  Colour colour;
};

struct Disc {
  PixelPoint centre;
  double radius_px = 3.0;
  Colour colour;
  bool filled = true;  ///< false: a ring, white inside
};

enum class Align : std::uint8_t { left, centre, right };

/// `at` is the baseline's left end, centre or right end. Letters beyond ASCII are replaced (ascii_text).
struct Label {
  std::string text;
  PixelPoint at;
  Align align = Align::left;
  double size = 1.0;  ///< of ordinary text
};

using Shape = std::variant<Stroke, Area, Disc, Label>;

/// Painted in order on white.
struct Drawing {
  int width_px = 0, height_px = 0;
  std::vector<Shape> shapes;
};

/// PNG. Errors: cannot_create, unavailable (a build without pictures).
Status write_drawing(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace scree::io
