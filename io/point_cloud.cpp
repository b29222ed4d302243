// The only file that sees PCL; what it is used for is in point_pcl.hpp, the other formats in point_files.cpp.

#include "io/point_cloud.hpp"

#include <fmt/format.h>

#include "io/point_pcl.hpp"

#ifdef SCREE_WITH_PCL
#include <cstring>
#include <optional>
#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include "io/point_collector.hpp"

namespace scree::io {
namespace {

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

std::uint8_t datatype_of(char type, std::uint64_t size) {
  switch (size) {
    case 1:
      return type == 'I' ? pcl::PCLPointField::INT8 : pcl::PCLPointField::UINT8;
    case 2:
      return type == 'I' ? pcl::PCLPointField::INT16 : pcl::PCLPointField::UINT16;
    case 4:
      if (type == 'F') return pcl::PCLPointField::FLOAT32;
      return type == 'I' ? pcl::PCLPointField::INT32 : pcl::PCLPointField::UINT32;
    default:
      return type == 'F' ? pcl::PCLPointField::FLOAT64 : 0;  // 8-byte integers are no coordinates
  }
}

/// An empty cloud of the header's layout, for PCL to fill.
pcl::PCLPointCloud2 blob_of(const PcdHeader& header) {
  pcl::PCLPointCloud2 blob;
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    pcl::PCLPointField& field = blob.fields.emplace_back();
    field.name = header.fields[i];
    field.offset = static_cast<std::uint32_t>(offset);
    field.datatype = datatype_of(header.types[i], header.sizes[i]);
    field.count = static_cast<std::uint32_t>(header.counts[i]);
    offset += header.sizes[i] * header.counts[i];
  }
  blob.width = static_cast<std::uint32_t>(header.width);
  blob.height = static_cast<std::uint32_t>(header.height);
  blob.point_step = static_cast<std::uint32_t>(offset);
  blob.row_step = static_cast<std::uint32_t>(offset * header.width);
  blob.data.resize(header.points * offset);
  return blob;
}

Error refused_by_pcl(const std::string& name, const char* format, const std::string& why) {
  return {ErrorKind::bad_data, fmt::format("{}: expected a {} file, PCL refuses it{}", name, format, why)};
}

}  // namespace

/// PCL unpacks the data behind a header that we have read: its own header reader goes on into the data, and crashes.
Result<PointCloud> unpack_binary_pcd(std::span<const std::uint8_t> bytes, const PcdHeader& header,
                                     const std::string& name) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // what it prints, our Error says
  try {
    pcl::PCLPointCloud2 blob = blob_of(header);
    const bool compressed = header.data == "binary_compressed";
    if (pcl::PCDReader().readBodyBinary(bytes.data(), blob, pcl::PCDReader::PCD_V7, compressed,
                                        static_cast<unsigned int>(header.data_offset)) < 0)
      return refused_by_pcl(name, "PCD", "");
    return to_cloud(blob, name);
  } catch (const std::exception& e) {
    return refused_by_pcl(name, "PCD", std::string(": ") + e.what());
  }
}

/// PCL reads the file by its name: it has no PLY reader from memory. The header has been checked.
Result<PointCloud> read_checked_ply(const std::filesystem::path& file) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  const std::string name = file.string();
  try {
    pcl::PCLPointCloud2 blob;
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0;
    if (pcl::PLYReader().read(name, blob, origin, orientation, version) < 0) return refused_by_pcl(name, "PLY", "");
    return to_cloud(blob, name);
  } catch (const std::exception& e) {
    return refused_by_pcl(name, "PLY", std::string(": ") + e.what());
  }
}

}  // namespace scree::io

#else

namespace scree::io {
namespace {

Error without_pcl(const std::string& name) {
  return {ErrorKind::unavailable, fmt::format("{}: binary PCD and PLY files need PCL, which this build leaves out "
                                              "(SCREE_WITH_PCL=OFF); ASCII PCD, .bin and text points work",
                                              name)};
}

}  // namespace

Result<PointCloud> unpack_binary_pcd(std::span<const std::uint8_t>, const PcdHeader&, const std::string& name) {
  return without_pcl(name);
}
Result<PointCloud> read_checked_ply(const std::filesystem::path& file) {
  return without_pcl(file.string());
}

}  // namespace scree::io

#endif
