// The payload of GEOMETRY, to bytes and back.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "drivers/frame_stream.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers::stream {
namespace {

constexpr ProjectionKind kKinds[] = {ProjectionKind::perceptron_usf, ProjectionKind::perceptron_cmu,
                                     ProjectionKind::spherical, ProjectionKind::pinhole};
constexpr Duration kMaxRowPeriod = std::chrono::seconds(10);

Error wrong(std::string_view field, std::string_view expected, const std::string& found) {
  return {ErrorKind::bad_data, fmt::format("GEOMETRY: {}: expected {}, found {}", field, expected, found)};
}

/// What a projection does not use is its default here and 0 on the wire.
ProjectionConfig used_fields(ProjectionConfig p) {
  const ProjectionConfig defaults;
  const bool perceptron = p.kind == ProjectionKind::perceptron_usf || p.kind == ProjectionKind::perceptron_cmu;
  if (p.kind != ProjectionKind::perceptron_usf) p.unit_m = defaults.unit_m;
  if (!perceptron) p.field_of_view_rad = defaults.field_of_view_rad;
  if (p.kind == ProjectionKind::pinhole) {
    p.range_per_count_m = defaults.range_per_count_m;
    p.range_offset_m = defaults.range_offset_m;
  } else {
    p.fx_px = p.fy_px = p.cx_px = p.cy_px = 0.0;
    p.depth_unit_m = defaults.depth_unit_m;
  }
  return p;
}

std::size_t angle_count(const ProjectionConfig& p) {
  if (p.kind != ProjectionKind::spherical) return 0;
  return static_cast<std::size_t>(p.rows) + static_cast<std::size_t>(p.columns);
}

void put_sensor(const SensorConfig& sensor, ByteWriter& out) {
  const Eigen::Vector3d& t = sensor.T_body_sensor.translation_m;
  const Eigen::Quaterniond& q = sensor.T_body_sensor.rotation;
  for (const double value :
       {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), sensor.noise.sigma_m, sensor.noise.sigma_per_m,
        sensor.noise.sigma_per_m2, sensor.noise.angle_rad, sensor.filter.range_min_m, sensor.filter.range_max_m})
    out.put(value);
}

Status take_sizes(ByteReader& in, Geometry& geometry) {
  ProjectionConfig& p = geometry.sensor.projection;
  const auto kind = in.take<std::uint8_t>();
  if (kind >= std::size(kKinds)) return wrong("projection", "0 … 3", fmt::to_string(kind));
  p.kind = kKinds[kind];
  geometry.word_bytes = in.take<std::uint8_t>();
  p.reflectance_shift = in.take<std::uint8_t>();
  in.skip(1);
  p.rows = in.take<std::uint16_t>();
  p.columns = in.take<std::uint16_t>();
  p.trusted_rows = in.take<std::uint16_t>();
  in.skip(2);
  p.invalid_raw = in.take<std::int32_t>();
  const bool words =
      geometry.word_bytes == 2 ? p.reflectance_shift == 0 : geometry.word_bytes == 4 && p.reflectance_shift != 0;
  if (!words)
    return wrong("word_bytes, reflectance_shift", "2 with 0, or 4 with 12 or 16",
                 fmt::format("{} with {}", geometry.word_bytes, p.reflectance_shift));
  if (p.rows < 1 || p.rows > kMaxSide || p.columns < 1 || p.columns > kMaxSide ||
      std::int64_t{p.rows} * p.columns > kMaxPixels)
    return wrong("rows, columns", fmt::format("1 … {} each, at most {} pixels", kMaxSide, kMaxPixels),
                 fmt::format("{} x {}", p.rows, p.columns));
  return {};
}

Status take_parameters(ByteReader& in, SensorConfig& sensor) {
  ProjectionConfig& p = sensor.projection;
  sensor.row_period = Duration(in.take<std::int64_t>());
  if (sensor.row_period < Duration{0} || sensor.row_period > kMaxRowPeriod)
    return wrong("row_period_ns", "0 … 10 s", fmt::to_string(sensor.row_period.count()));
  p.unit_m = in.take<double>();
  for (double& field : p.field_of_view_rad) field = in.take<double>();
  for (double* value : {&p.range_per_count_m, &p.range_offset_m, &p.fx_px, &p.fy_px, &p.cx_px, &p.cy_px,
                        &p.depth_unit_m, &p.ambiguity_m})
    *value = in.take<double>();
  p = used_fields(std::move(p));
  // Zero asks for a default in a configuration; here it is a field that a complete geometry has left out.
  const bool perceptron = p.kind == ProjectionKind::perceptron_usf || p.kind == ProjectionKind::perceptron_cmu;
  if (perceptron && !(p.range_per_count_m > 0.0 && p.field_of_view_rad[0] > 0.0 && p.field_of_view_rad[1] > 0.0))
    return wrong("range_per_count_m, field_of_view_rad", "positive numbers",
                 fmt::format("{}, ({}, {})", p.range_per_count_m, p.field_of_view_rad[0], p.field_of_view_rad[1]));
  if (!(p.ambiguity_m >= 0.0)) return wrong("ambiguity_m", "0 or more", fmt::to_string(p.ambiguity_m));
  return {};
}

Status take_sensor(ByteReader& in, SensorConfig& sensor) {
  Eigen::Vector3d& t = sensor.T_body_sensor.translation_m;
  for (int axis = 0; axis < 3; ++axis) t[axis] = in.take<double>();
  const auto x = in.take<double>(), y = in.take<double>(), z = in.take<double>(), w = in.take<double>();
  sensor.T_body_sensor.rotation = Eigen::Quaterniond(w, x, y, z);
  const double norm = sensor.T_body_sensor.rotation.norm();
  if (!(t.allFinite() && t.cwiseAbs().maxCoeff() <= kMaxCoordinate_m && std::abs(norm - 1.0) <= 1e-3))
    return wrong("T_body_sensor", "finite metres and a quaternion of norm 1",
                 fmt::format("({}, {}, {}), norm {}", t.x(), t.y(), t.z(), norm));
  if (std::abs(norm - 1.0) > 1e-12) sensor.T_body_sensor.rotation.normalize();  // kept to the last bit otherwise
  for (double* value : {&sensor.noise.sigma_m, &sensor.noise.sigma_per_m, &sensor.noise.sigma_per_m2,
                        &sensor.noise.angle_rad, &sensor.filter.range_min_m, &sensor.filter.range_max_m}) {
    *value = in.take<double>();
    if (!(*value >= 0.0 && *value <= 1e6)) return wrong("noise and range limits", "0 … 1e6", fmt::to_string(*value));
  }
  return {};
}

Status take_device(ByteReader& in, std::string& device) {
  const auto* text = reinterpret_cast<const char*>(in.here());
  device.assign(text, std::find(text, text + kDeviceBytes, '\0'));
  in.skip(kDeviceBytes);
  const bool printable =
      std::all_of(device.begin(), device.end(), [](char c) { return c >= ' ' && static_cast<unsigned char>(c) < 127; });
  if (device.empty() || device.size() == kDeviceBytes || !printable)
    return wrong("device", "1 … 31 visible ASCII characters", fmt::format("{} bytes", device.size()));
  return {};
}

}  // namespace

std::vector<std::uint8_t> encode_geometry(const Geometry& geometry) {
  const ProjectionConfig p = used_fields(geometry.sensor.projection);
  const double unit_m = p.kind == ProjectionKind::perceptron_usf ? p.unit_m : 0.0;
  const double depth_unit_m = p.kind == ProjectionKind::pinhole ? p.depth_unit_m : 0.0;
  std::vector<std::uint8_t> payload(kGeometryBytes + 8 * angle_count(p));
  ByteWriter out(payload);
  out.put(static_cast<std::uint8_t>(std::find(std::begin(kKinds), std::end(kKinds), p.kind) - std::begin(kKinds)));
  out.put(static_cast<std::uint8_t>(geometry.word_bytes));
  out.put(static_cast<std::uint8_t>(p.reflectance_shift));
  out.fill(1);
  for (const int size : {p.rows, p.columns, p.trusted_rows, 0}) out.put(static_cast<std::uint16_t>(size));
  out.put(static_cast<std::int32_t>(p.invalid_raw));
  out.put(std::int64_t{geometry.sensor.row_period.count()});
  for (const double value : {unit_m, p.field_of_view_rad[0], p.field_of_view_rad[1], p.range_per_count_m,
                             p.range_offset_m, p.fx_px, p.fy_px, p.cx_px, p.cy_px, depth_unit_m, p.ambiguity_m})
    out.put(value);
  put_sensor(geometry.sensor, out);
  for (std::size_t i = 0; i < kDeviceBytes; ++i)
    out.put(i < geometry.device.size() ? static_cast<std::uint8_t>(geometry.device[i]) : std::uint8_t{0});
  if (p.kind == ProjectionKind::spherical) {
    for (const double angle : p.row_elevations_rad) out.put(angle);
    for (const double angle : p.column_azimuths_rad) out.put(angle);
  }
  return payload;
}

Result<Geometry> decode_geometry(std::span<const std::uint8_t> payload, std::uint8_t version_minor) {
  if (payload.size() < kGeometryBytes)
    return wrong("payload", fmt::format("at least {} bytes", kGeometryBytes), fmt::to_string(payload.size()));
  Geometry geometry;
  ProjectionConfig& p = geometry.sensor.projection;
  ByteReader in(payload);
  if (const auto taken = take_sizes(in, geometry); !taken) return taken.error();
  const std::size_t bytes = kGeometryBytes + 8 * angle_count(p);
  if (payload.size() < bytes || (version_minor == 0 && payload.size() > bytes))
    return wrong("payload", fmt::format("{} bytes", bytes), fmt::to_string(payload.size()));
  if (const auto taken = take_parameters(in, geometry.sensor); !taken) return taken.error();
  if (const auto taken = take_sensor(in, geometry.sensor); !taken) return taken.error();
  if (const auto taken = take_device(in, geometry.device); !taken) return taken.error();
  if (p.kind == ProjectionKind::spherical) {
    for (int r = 0; r < p.rows; ++r) p.row_elevations_rad.push_back(in.take<double>());
    for (int c = 0; c < p.columns; ++c) p.column_azimuths_rad.push_back(in.take<double>());
  }
  auto complete = complete_projection(p, p.rows, p.columns);
  if (!complete) return Error{ErrorKind::bad_data, "GEOMETRY: " + complete.error().message};
  p = *std::move(complete);
  return geometry;
}

}  // namespace scree::drivers::stream
