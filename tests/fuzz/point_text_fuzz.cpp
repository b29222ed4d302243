// Any text: the point reader accepts or refuses; accepted points are finite. The header checks of PCD and PLY, which
// stand between a file and PCL, see the same bytes.

#include <cstdint>
#include <cstdlib>

#include "io/point_cloud.hpp"
#include "io/point_header.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto cloud = scree::io::parse_point_text(text, "fuzz");
  if (cloud) {
    if (!cloud->origin_m.allFinite()) std::abort();
    for (const auto& point : cloud->points)
      if (!point.allFinite()) std::abort();
  }
  const std::string_view head = text.substr(0, scree::io::kPointHeaderMaxBytes);
  if (const auto pcd = scree::io::check_pcd_header(head, size, "fuzz"); pcd && pcd->data_offset > size) std::abort();
  (void)scree::io::check_ply_header(head, size, "fuzz");
  return 0;
}
