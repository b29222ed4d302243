#pragma once
// One file of a recording → projection and ranges of a frame.

#include <filesystem>
#include <optional>
#include <vector>

#include "drivers/depth_image.hpp"
#include "drivers/frame/range_frame.hpp"
#include "drivers/perceptron_file.hpp"

namespace scree::drivers {

/// Errors: bad_data when a depth image (`layout` none) or a range file of that layout cannot come from a sensor of
/// `kind`; it names both.
Status check_file_kind(const std::string& name, std::optional<RangeFileLayout> layout, ProjectionKind kind);

/// Reads frame files of one sensor. Image projections: `.pgm` is a 16-bit depth image, anything else a Perceptron range
/// file, whose kind must be the projection's; the image size is the projection's, or that of the first frame where the
/// projection leaves it open. Clouds:
/// `.bin`, or what io::read_point_cloud knows. Keeps its buffers; one thread.
class RecordedFrameReader {
 public:
  explicit RecordedFrameReader(const SensorConfig& sensor)
      : config_(sensor.projection), min_reflectance_(sensor.filter.min_reflectance) {}

  /// Fills `projection` and `range_m`: metres along the ray, NaN for the declared invalid code, for returns below the
  /// sensor's min_reflectance and for points of a
  /// cloud that are not finite or lie in the sensor's origin. `warning` is set or cleared. Errors: no_input, io,
  /// bad_data (the file or its size), unavailable (a format that this build leaves out).
  Status read(const std::filesystem::path& file, RangeFrame& frame, std::string& warning);

 private:
  Status read_image(const std::filesystem::path& file, RangeFrame& frame, std::string& warning);
  Status read_cloud(const std::filesystem::path& file, RangeFrame& frame);
  Status drop_weak_returns(const std::string& name, Grid<float>& range_m) const;
  Status fit_projection(const std::string& name, int rows, int columns);

  ProjectionConfig config_;
  int min_reflectance_ = 0;
  std::shared_ptr<const Projection> projection_;  ///< of images, once their size is known
  std::vector<std::uint8_t> bytes_;
  RangeFile range_file_;
  Grid<std::uint16_t> depth_image_;
  std::vector<Eigen::Vector4f> points_;
  std::vector<Eigen::Vector3f> directions_;
};

}  // namespace scree::drivers
