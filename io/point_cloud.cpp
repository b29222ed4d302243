// The only file that sees PCL.

#include "io/point_cloud.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

#include "io/file_bytes.hpp"
#include "io/point_collector.hpp"
#include "io/point_header.hpp"

#ifdef SCREE_WITH_PCL
#include <fstream>
#include <optional>
#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#endif

namespace scree::io {
namespace {

static_assert(std::endian::native == std::endian::little, ".bin files are read into memory as they are");

Result<PointCloud> read_bin(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (const auto read = read_bytes(file, kPointFileMaxBytes, bytes); !read) return read.error();
  PointCloud cloud;
  if (const auto parsed = parse_bin_points(bytes, file.string(), cloud.points); !parsed) return parsed.error();
  cloud.dropped_non_finite =
      std::erase_if(cloud.points, [](const Eigen::Vector4f& p) { return !p.head<3>().allFinite(); });
  if (cloud.points.empty())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected at least one finite point, found {} points, none finite", file.string(),
                             cloud.dropped_non_finite)};
  for (Eigen::Vector4f& p : cloud.points)
    if (!std::isfinite(p[3])) p[3] = 0.0f;
  return cloud;
}

Result<PointCloud> read_text(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (const auto read = read_bytes(file, kPointFileMaxBytes, bytes); !read) return read.error();
  return parse_point_text(as_text(bytes), file.string());
}

#ifdef SCREE_WITH_PCL

double number_at(const std::uint8_t* bytes, std::uint8_t datatype) {
  const auto load = [bytes]<class T>(T value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  };
  switch (datatype) {
    case pcl::PCLPointField::INT8:
      return load(std::int8_t{});
    case pcl::PCLPointField::UINT8:
      return load(std::uint8_t{});
    case pcl::PCLPointField::INT16:
      return load(std::int16_t{});
    case pcl::PCLPointField::UINT16:
      return load(std::uint16_t{});
    case pcl::PCLPointField::INT32:
      return load(std::int32_t{});
    case pcl::PCLPointField::UINT32:
      return load(std::uint32_t{});
    case pcl::PCLPointField::FLOAT32:
      return load(float{});
    case pcl::PCLPointField::FLOAT64:
      return load(double{});
    default:
      return 0.0;
  }
}

std::size_t size_of(std::uint8_t datatype) {
  switch (datatype) {
    case pcl::PCLPointField::INT8:
    case pcl::PCLPointField::UINT8:
      return 1;
    case pcl::PCLPointField::INT16:
    case pcl::PCLPointField::UINT16:
      return 2;
    case pcl::PCLPointField::INT32:
    case pcl::PCLPointField::UINT32:
    case pcl::PCLPointField::FLOAT32:
      return 4;
    case pcl::PCLPointField::FLOAT64:
      return 8;
    default:
      return 0;
  }
}

/// The field of that name, if it is a number that lies inside a point.
std::optional<pcl::PCLPointField> find_field(const pcl::PCLPointCloud2& blob, std::string_view name) {
  for (const auto& field : blob.fields) {
    const std::size_t size = size_of(field.datatype);
    if (field.name == name && size > 0 && field.offset + size <= blob.point_step) return field;
  }
  return std::nullopt;
}

Result<PointCloud> to_cloud(const pcl::PCLPointCloud2& blob, const std::string& name) {
  const auto x = find_field(blob, "x"), y = find_field(blob, "y"), z = find_field(blob, "z");
  if (!x || !y || !z) {
    std::string found;
    for (const auto& field : blob.fields) found += (found.empty() ? "" : ",") + field.name;
    return Error{ErrorKind::bad_data, fmt::format("{}: expected the fields x, y and z, found '{}'", name, found)};
  }
  const auto intensity = find_field(blob, "intensity");
  const std::size_t count = std::size_t{blob.width} * blob.height;
  if (blob.is_bigendian != 0 || blob.data.size() < count * blob.point_step)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected {} points of {} bytes, found {} bytes", name, count,
                                                  blob.point_step, blob.data.size())};
  PointCollector points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* point = blob.data.data() + i * blob.point_step;
    const auto value = [point](const pcl::PCLPointField& f) { return number_at(point + f.offset, f.datatype); };
    points.add({value(*x), value(*y), value(*z)}, intensity ? value(*intensity) : 0.0);
  }
  return std::move(points).finish(name);
}

/// PCL reads the file a second time, by its name: it has no reader from memory for both formats.
template <class Reader>
Result<PointCloud> read_with_pcl(const std::filesystem::path& file, const char* format) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // what it prints, our Error says
  const std::string name = file.string();
  try {
    pcl::PCLPointCloud2 blob;
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0;
    const int status = Reader().read(name, blob, origin, orientation, version);
    if (status < 0)
      return Error{ErrorKind::bad_data, fmt::format("{}: expected a {} file, PCL cannot read it as one", name, format)};
    return to_cloud(blob, name);
  } catch (const std::exception& e) {
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a {} file, PCL refuses it: {}", name, format, e.what())};
  }
}

Result<PointCloud> read_pcl(const std::filesystem::path& file, bool pcd) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(kPointHeaderMaxBytes, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  std::error_code failed;
  const auto size = std::filesystem::file_size(file, failed);
  if (failed || stream.bad()) return Error{ErrorKind::no_input, fmt::format("{}: cannot be read", file.string())};
  const auto plausible =
      pcd ? check_pcd_header(head, size, file.string()) : check_ply_header(head, size, file.string());
  if (!plausible) return plausible.error();
  return pcd ? read_with_pcl<pcl::PCDReader>(file, "PCD") : read_with_pcl<pcl::PLYReader>(file, "PLY");
}

#else

Result<PointCloud> read_pcl(const std::filesystem::path& file, bool) {
  return Error{ErrorKind::unavailable, fmt::format("{}: PCD and PLY files need PCL, which this build leaves out "
                                                   "(SCREE_WITH_PCL=OFF); .bin and text points work",
                                                   file.string())};
}

#endif

}  // namespace

Status parse_bin_points(std::span<const std::uint8_t> bytes, const std::string& name,
                        std::vector<Eigen::Vector4f>& points) {
  static_assert(sizeof(Eigen::Vector4f) == 16);
  if (bytes.size() % 16 != 0)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected points of 16 bytes (float32 x y z intensity), found {} "
                                                  "bytes: {} are left over at byte {}",
                                                  name, bytes.size(), bytes.size() % 16, bytes.size() / 16 * 16)};
  points.resize(bytes.size() / 16);
  if (!bytes.empty()) std::memcpy(points.front().data(), bytes.data(), bytes.size());
  return {};
}

Result<PointCloud> read_point_cloud(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    return Error{ErrorKind::no_input, file.string() + ": expected a point file, found none"};
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (extension == ".pcd" || extension == ".ply") return read_pcl(file, extension == ".pcd");
  if (extension == ".bin") return read_bin(file);
  if (extension == ".xyz" || extension == ".txt" || extension == ".csv") return read_text(file);
  return Error{ErrorKind::bad_data,
               fmt::format("{}: expected a point file (.pcd .ply .bin .xyz .txt .csv), found extension '{}'",
                           file.string(), extension)};
}

}  // namespace scree::io
