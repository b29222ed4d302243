// Point files by extension, and the formats that need no library.

#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

#include "io/file_bytes.hpp"
#include "io/point_cloud.hpp"
#include "io/point_header.hpp"
#include "io/point_pcl.hpp"

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

/// Not through PCL: it makes a point in the origin of a line that it cannot read.
Result<PointCloud> parse_ascii_pcd(std::string_view text, const PcdHeader& header, const std::string& name) {
  std::string columns;  // of an array only the first number has a name
  for (std::size_t i = 0; i < header.fields.size(); ++i)
    columns.append(i == 0 ? "" : ",").append(header.fields[i]).append(header.counts[i] - 1, ',');
  auto cloud = parse_point_text(columns + "\n" + std::string(text.substr(header.data_offset)), name, header.data_line);
  if (!cloud) return cloud;
  if (const std::size_t found = cloud->points.size() + cloud->dropped_non_finite; found != header.points)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected {} points, found {}", name, header.points, found)};
  return cloud;
}

Result<PointCloud> read_pcd(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::vector<std::uint8_t> bytes;
  if (const auto read = read_bytes(file, kPointFileMaxBytes, bytes); !read) return read.error();
  const std::string_view text = as_text(bytes);
  const auto header = check_pcd_header(text.substr(0, kPointHeaderMaxBytes), text.size(), name);
  if (!header) return header.error();
  return header->data == "ascii" ? parse_ascii_pcd(text, *header, name) : unpack_binary_pcd(bytes, *header, name);
}

Result<PointCloud> read_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(kPointHeaderMaxBytes, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  std::error_code failed;
  const auto size = std::filesystem::file_size(file, failed);
  if (!stream.is_open() || stream.bad() || failed)
    return Error{ErrorKind::no_input, file.string() + ": cannot be read"};
  if (const auto checked = check_ply_header(head, size, file.string()); !checked) return checked.error();
  return read_checked_ply(file);
}

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
  if (extension == ".pcd") return read_pcd(file);
  if (extension == ".ply") return read_ply(file);
  if (extension == ".bin") return read_bin(file);
  if (extension == ".xyz" || extension == ".txt" || extension == ".csv") return read_text(file);
  return Error{ErrorKind::bad_data,
               fmt::format("{}: expected a point file (.pcd .ply .bin .xyz .txt .csv), found extension '{}'",
                           file.string(), extension)};
}

}  // namespace scree::io
