#include "drivers/recording_frame.hpp"

#include <fmt/format.h>
#include <limits>

#include "core/simd.hpp"
#include "io/file_bytes.hpp"
#include "io/point_cloud.hpp"

namespace scree::drivers {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

SCREE_CLONES void raw_to_range(const std::uint16_t* raw, const float* offset_m, const float* per_count_m,
                               std::int32_t invalid_raw, std::size_t count, float* range_m) {
  for (std::size_t i = 0; i < count; ++i) {
    const float range = offset_m[i] + static_cast<float>(raw[i]) * per_count_m[i];
    range_m[i] = raw[i] == invalid_raw ? kNaN : range;
  }
}

bool is_depth_image(const std::filesystem::path& file) {
  return file.extension() == ".pgm";
}

const char* projection_name(ProjectionKind kind) {
  switch (kind) {
    case ProjectionKind::perceptron_usf:
      return "perceptron_usf";
    case ProjectionKind::perceptron_cmu:
      return "perceptron_cmu";
    case ProjectionKind::spherical:
      return "spherical";
    case ProjectionKind::pinhole:
      return "pinhole";
    case ProjectionKind::cloud:
      return "cloud";
  }
  return "unknown";
}

/// What files a sensor of `kind` makes, in words.
const char* files_of(ProjectionKind kind) {
  switch (kind) {
    case ProjectionKind::perceptron_usf:
      return "a range file with a USF header";
    case ProjectionKind::perceptron_cmu:
      return "a headerless CMU range file";
    case ProjectionKind::spherical:
    case ProjectionKind::pinhole:
      return "a 16-bit .pgm image";
    case ProjectionKind::cloud:
      return "a point cloud";
  }
  return "nothing";
}

bool makes(ProjectionKind kind, std::optional<RangeFileLayout> layout) {
  if (!layout) return kind == ProjectionKind::pinhole || kind == ProjectionKind::spherical;
  return kind == (*layout == RangeFileLayout::usf ? ProjectionKind::perceptron_usf : ProjectionKind::perceptron_cmu);
}

}  // namespace

Status check_file_kind(const std::string& name, std::optional<RangeFileLayout> layout, ProjectionKind kind) {
  if (makes(kind, layout)) return {};
  return Error{ErrorKind::bad_data,
               fmt::format("{}: expected {} (projection {}), found {} {}", name, files_of(kind), projection_name(kind),
                           layout ? "a range file:" : "a 16-bit", layout ? to_string(*layout) : ".pgm image")};
}

Status RecordedFrameReader::read(const std::filesystem::path& file, RangeFrame& frame, std::string& warning) {
  warning.clear();
  return config_.kind == ProjectionKind::cloud ? read_cloud(file, frame) : read_image(file, frame, warning);
}

/// The tables are made for the first frame whose size they fit; a frame of another size is that frame's fault.
Status RecordedFrameReader::fit_projection(const std::string& name, int rows, int columns) {
  const int expected_rows = projection_ ? projection_->rows : config_.rows;
  const int expected_columns = projection_ ? projection_->columns : config_.columns;
  if ((expected_rows > 0 && rows != expected_rows) || (expected_columns > 0 && columns != expected_columns))
    return Error{ErrorKind::bad_data, fmt::format("{}: expected an image of {} rows and {} columns{}, found {} x {}",
                                                  name, expected_rows > 0 ? fmt::to_string(expected_rows) : "any",
                                                  expected_columns > 0 ? fmt::to_string(expected_columns) : "any",
                                                  projection_ ? ", like the first" : "", rows, columns)};
  if (projection_) return {};
  auto projection = make_projection(config_, rows, columns);
  if (!projection) return Error{projection.error().kind, name + ": " + projection.error().message};
  projection_ = std::move(*projection);
  return {};
}

Status RecordedFrameReader::read_image(const std::filesystem::path& file, RangeFrame& frame, std::string& warning) {
  const std::string name = file.string();
  const bool depth = is_depth_image(file);
  if (auto read = io::read_bytes(file, depth ? kDepthImageMaxBytes : kRangeFileMaxBytes, bytes_); !read) return read;
  if (depth) {
    if (auto parsed = parse_depth_image(bytes_, name, depth_image_); !parsed) return parsed;
  } else {
    const RangeFileOptions options{.reflectance_shift = min_reflectance_ > 0 ? config_.reflectance_shift : 0,
                                   .lenient = config_.lenient};
    if (auto parsed = parse_range_file(bytes_, name, options, range_file_); !parsed) return parsed;
    warning = range_file_.warning;
  }
  if (auto fits = check_file_kind(name, depth ? std::nullopt : std::optional(range_file_.layout), config_.kind); !fits)
    return fits;
  const Grid<std::uint16_t>& raw = depth ? depth_image_ : range_file_.raw;
  if (auto fits = fit_projection(name, raw.rows(), raw.columns()); !fits) return fits;
  frame.projection = projection_;
  frame.range_m.assign(raw.rows(), raw.columns(), 0.0f);
  raw_to_range(raw.data(), projection_->range_offset_m.data(), projection_->range_per_count_m.data(),
               static_cast<std::int32_t>(projection_->config.invalid_raw), raw.size(), frame.range_m.data());
  frame.raw = raw;
  frame.reflectance = depth ? Grid<std::uint16_t>() : range_file_.reflectance;
  return depth ? Status{} : drop_weak_returns(name, frame.range_m);
}

Status RecordedFrameReader::drop_weak_returns(const std::string& name, Grid<float>& range_m) const {
  if (min_reflectance_ <= 0) return {};
  const Grid<std::uint16_t>& reflectance = range_file_.reflectance;
  if (reflectance.size() != range_m.size())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected words with a reflectance (min_reflectance {}), found {}", name,
                             min_reflectance_, to_string(range_file_.layout))};
  for (std::size_t i = 0; i < range_m.size(); ++i)
    if (reflectance[i] < min_reflectance_) range_m[i] = kNaN;
  return {};
}

Status RecordedFrameReader::read_cloud(const std::filesystem::path& file, RangeFrame& frame) {
  std::size_t lost = 0;  // non-finite points that the reader took out already
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
  if (file.extension() == ".bin") {
    if (auto read = io::read_bytes(file, io::kPointFileMaxBytes, bytes_); !read) return read;
    if (auto parsed = io::parse_bin_points(bytes_, file.string(), points_); !parsed) return parsed;
  } else {
    auto cloud = io::read_point_cloud(file);
    if (!cloud) return cloud.error();
    points_ = std::move(cloud->points);
    lost = cloud->dropped_non_finite;
    origin_m = cloud->origin_m.cast<float>();
  }
  directions_.clear();
  for (const Eigen::Vector4f& point : points_) directions_.emplace_back(point.head<3>() + origin_m);
  directions_.resize(directions_.size() + lost, Eigen::Vector3f::Constant(kNaN));
  // A point without a range keeps its pixel, with NaN for its range: so it is counted as "no return" like any other.
  std::vector<std::size_t> without_range;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    if (directions_[i].allFinite() && !directions_[i].isZero(0.0f)) continue;
    directions_[i] = Eigen::Vector3f::UnitX();
    without_range.push_back(i);
  }
  if (without_range.size() == directions_.size())
    return Error{ErrorKind::bad_data, fmt::format("{}: expected at least one finite point away from the sensor, found "
                                                  "{} points and none of those",
                                                  file.string(), directions_.size())};
  auto projection = make_cloud_projection(directions_);
  frame.range_m = projection->range_offset_m;
  for (const std::size_t i : without_range) frame.range_m[i] = kNaN;
  frame.projection = std::move(projection);
  return {};
}

}  // namespace scree::drivers
