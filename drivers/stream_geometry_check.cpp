// Whether a device is the one that was configured.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "drivers/stream_frame_reader.hpp"

namespace scree::drivers::stream {
namespace {

/// Parameters come as decimal text on one side: equal to the digits that anyone writes.
bool same(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(1.0, std::max(std::abs(a), std::abs(b)));
}

}  // namespace

Status check_same_projection(const std::string& name, const ProjectionConfig& expected, const ProjectionConfig& found) {
  const auto differs = [&](std::string_view key, const std::string& a, const std::string& b) {
    return Error{
        ErrorKind::bad_config,
        fmt::format("{}: sensor.{}: expected {}, as configured, found a device that says {}", name, key, a, b)};
  };
  if (expected.kind != found.kind) return differs("projection", to_string(expected.kind), to_string(found.kind));
  struct Number {
    const char* key;
    double expected, found;
  };
  const Number numbers[] = {
      {"parameters.rows", static_cast<double>(expected.rows), static_cast<double>(found.rows)},
      {"parameters.columns", static_cast<double>(expected.columns), static_cast<double>(found.columns)},
      {"parameters.invalid_raw", static_cast<double>(expected.invalid_raw), static_cast<double>(found.invalid_raw)},
      {"parameters.unit_m", expected.unit_m, found.unit_m},
      {"parameters.field_of_view_rad[0]", expected.field_of_view_rad[0], found.field_of_view_rad[0]},
      {"parameters.field_of_view_rad[1]", expected.field_of_view_rad[1], found.field_of_view_rad[1]},
      {"parameters.range_per_count_m", expected.range_per_count_m, found.range_per_count_m},
      {"parameters.range_offset_m", expected.range_offset_m, found.range_offset_m},
      {"parameters.fx_px", expected.fx_px, found.fx_px},
      {"parameters.fy_px", expected.fy_px, found.fy_px},
      {"parameters.cx_px", expected.cx_px, found.cx_px},
      {"parameters.cy_px", expected.cy_px, found.cy_px},
      {"parameters.depth_unit_m", expected.depth_unit_m, found.depth_unit_m},
      {"parameters.ambiguity_m", expected.ambiguity_m, found.ambiguity_m},
  };
  for (const Number& n : numbers)
    if (!same(n.expected, n.found)) return differs(n.key, fmt::format("{}", n.expected), fmt::format("{}", n.found));
  const auto check_angles = [&](const char* key, const auto& a, const auto& b) -> Status {
    if (a.size() != b.size()) return differs(key, fmt::format("{} angles", a.size()), fmt::format("{}", b.size()));
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!same(a[i], b[i])) return differs(fmt::format("{}[{}]", key, i), fmt::to_string(a[i]), fmt::to_string(b[i]));
    return {};
  };
  if (auto rows = check_angles("parameters.row_elevations_rad", expected.row_elevations_rad, found.row_elevations_rad);
      !rows)
    return rows;
  return check_angles("parameters.column_azimuths_rad", expected.column_azimuths_rad, found.column_azimuths_rad);
}

}  // namespace scree::drivers::stream
