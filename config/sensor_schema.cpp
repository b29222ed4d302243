#include "config/sensor_schema.hpp"

#include <fmt/format.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/key_types.hpp"
#include "config/values.hpp"

namespace scree::config {
namespace {

void add_range_limits(Schema<SensorConfig>& schema) {
  schema.keys.push_back(seconds<SensorConfig>(
      "row_period_s", [](SensorConfig& s) -> Duration& { return s.row_period; }, {0, 10, false},
      "Row r is taken at frame time + r · row_period_s; 0 = all at once."));
  schema.keys.push_back(number<SensorConfig>(
      "range_min_m", [](SensorConfig& s) -> double& { return s.filter.range_min_m; }, {0, 1e4, false},
      "Nearer returns are dropped and counted."));
  schema.keys.push_back(number<SensorConfig>(
      "range_max_m", [](SensorConfig& s) -> double& { return s.filter.range_max_m; }, {0, 1e4, true},
      "Farther returns are dropped and counted."));
  schema.keys.push_back(number<SensorConfig>(
      "range_sigma_m", [](SensorConfig& s) -> double& { return s.noise.sigma_m; }, {0, 100, false},
      "Standard deviation of a range, constant part."));
  schema.keys.push_back(number<SensorConfig>(
      "range_sigma_per_m", [](SensorConfig& s) -> double& { return s.noise.sigma_per_m; }, {0, 10, false},
      "Part that grows with the range ρ."));
  schema.keys.push_back(number<SensorConfig>(
      "range_sigma_per_m2", [](SensorConfig& s) -> double& { return s.noise.sigma_per_m2; }, {0, 10, false},
      "Part that grows with ρ²."));
  schema.keys.push_back(number<SensorConfig>(
      "angle_sigma_rad", [](SensorConfig& s) -> double& { return s.noise.angle_rad; }, {0, 0.5, false},
      "Standard deviation of a ray's direction about each of two axes; 0 = none told."));
  schema.rules.push_back({{"range_max_m", "range_min_m"}, [](const SensorConfig& s) -> std::optional<Contradiction> {
                            if (s.filter.range_min_m < s.filter.range_max_m) return std::nullopt;
                            return Contradiction{"range_min_m below range_max_m",
                                                 fmt::format("{} and {}", s.filter.range_min_m, s.filter.range_max_m)};
                          }});
}

std::optional<Eigen::Vector3d> read_corner(const YamlNode& node) {
  const auto values = read_numbers(node);
  if (!values || values->size() != 3) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

/// none or {min_m: [x, y, z], max_m: [x, y, z]}
Key<SensorConfig> self_mask() {
  Key<SensorConfig> key{"filter.self_mask",
                        "none or {min_m: [x, y, z], max_m: [x, y, z]} with every min below its max",
                        "Box in the body frame; returns inside are the robot itself.",
                        {},
                        {},
                        {},
                        nullptr,
                        {},
                        false};
  key.read = [](const YamlNode& node, SensorConfig& sensor) {
    if (read_text(node) == "none") return sensor.filter.self_mask.reset(), true;
    if (node.kind != YamlNode::Kind::map || node.keys.size() != 2) return false;
    const bool ordered = node.keys[0].scalar == "min_m" && node.keys[1].scalar == "max_m";
    if (!ordered && !(node.keys[0].scalar == "max_m" && node.keys[1].scalar == "min_m")) return false;
    const auto min = read_corner(node.items[ordered ? 0 : 1]);
    const auto max = read_corner(node.items[ordered ? 1 : 0]);
    if (!min || !max || !(min->array() < max->array()).all()) return false;
    sensor.filter.self_mask = BodyBox{*min, *max};
    return true;
  };
  key.write = [](const SensorConfig& sensor) {
    if (!sensor.filter.self_mask) return std::string("none");
    const auto& [min, max] = *sensor.filter.self_mask;
    return fmt::format("{{min_m: {}, max_m: {}}}", write_numbers({min.x(), min.y(), min.z()}),
                       write_numbers({max.x(), max.y(), max.z()}));
  };
  key.copy = [](const SensorConfig& from, SensorConfig& to) { to.filter.self_mask = from.filter.self_mask; };
  return key;
}

void add_phase_evidence(Schema<FilterConfig>& schema) {
  schema.keys.push_back(number<FilterConfig>(
      "anchor_slope_rad", [](FilterConfig& f) -> double& { return f.anchor_slope_rad; }, {0, 1.5, false},
      "Evidence for a phase interval: near ground lies within anchor_height_m plus this slope of the body's z = 0."));
  schema.keys.push_back(number<FilterConfig>(
      "anchor_height_m", [](FilterConfig& f) -> double& { return f.anchor_height_m; }, {0, 100, false},
      "See anchor_slope_rad."));
  schema.keys.push_back(number<FilterConfig>(
      "map_gate_sigmas", [](FilterConfig& f) -> double& { return f.map_gate_sigmas; }, {0, 100, true},
      "Evidence for a phase interval: heights agree with the map within this many standard deviations plus "
      "map_gate_m."));
  schema.keys.push_back(number<FilterConfig>(
      "map_gate_m", [](FilterConfig& f) -> double& { return f.map_gate_m; }, {0, 100, false}, "See map_gate_sigmas."));
  schema.keys.push_back(integer<FilterConfig, int>(
      "anchor_min_pixels", [](FilterConfig& f) -> int& { return f.anchor_min_pixels; }, {1, 1e6, false},
      "Agreeing pixels without which a surface gets no interval."));
}

Schema<FilterConfig> filter_schema() {
  Schema<FilterConfig> schema;
  schema.keys.push_back(integer<FilterConfig, int>(
      "min_reflectance", [](FilterConfig& f) -> int& { return f.min_reflectance; }, {0, 4095, false},
      "Returns of a weaker reflectance count as no return; needs parameters.reflectance_shift; 0 = off."));
  schema.keys.push_back(integer<FilterConfig, int>(
      "speckle_min_pixels", [](FilterConfig& f) -> int& { return f.speckle_min_pixels; }, {0, 1e6, false},
      "A surface of fewer pixels is speckle; 0 = off."));
  schema.keys.push_back(number<FilterConfig>(
      "join_m", [](FilterConfig& f) -> double& { return f.join_m; }, {0, 100, false},
      "Neighbours are one surface when their ranges differ by less than "
      "join_m + join_ratio · range."));
  schema.keys.push_back(number<FilterConfig>(
      "join_ratio", [](FilterConfig& f) -> double& { return f.join_ratio; }, {0, 1, false}, "See join_m."));
  schema.keys.push_back(flag<FilterConfig>(
      "mixed_pixels", [](FilterConfig& f) -> bool& { return f.mixed_pixels; },
      "Drop returns that hang between two surfaces."));
  schema.keys.push_back(number<FilterConfig>(
      "grazing_rad", [](FilterConfig& f) -> double& { return f.grazing_rad; }, {0, 1.5, false},
      "A ray that meets the chord to a neighbour at less than this grazes it; grazing on both sides is a mixed "
      "pixel."));
  schema.keys.push_back(choice<FilterConfig, PhasePolicy>(
      "phase", [](FilterConfig& f) -> PhasePolicy& { return f.phase; },
      {{"resolve", PhasePolicy::resolve}, {"first_interval", PhasePolicy::first_interval}},
      "resolve: drop what no anchor tells the phase interval of; first_interval: take a frame without any anchor to be "
      "in the first."));
  schema.keys.push_back(integer<FilterConfig, int>(
      "max_wraps", [](FilterConfig& f) -> int& { return f.max_wraps; }, {0, 16, false},
      "Phase intervals considered beyond the first."));
  add_phase_evidence(schema);
  return schema;
}

}  // namespace

Schema<SensorConfig> sensor_schema(bool required) {
  Schema<SensorConfig> schema;
  schema.keys.push_back(choice<SensorConfig, ProjectionKind>(
      "projection", [](SensorConfig& s) -> ProjectionKind& { return s.projection.kind; }, projections(),
      "Geometry of the sensor."));
  schema.keys.back().required = required;
  append(schema, "parameters.",
         Lens<SensorConfig, ProjectionConfig>([](SensorConfig& s) -> ProjectionConfig& { return s.projection; }),
         parameter_schema());
  for (auto& key : schema.keys) {
    if (key.applies) key.applies_key = "projection";
  }
  append(schema, "T_body_sensor.", Lens<SensorConfig, Pose>([](SensorConfig& s) -> Pose& { return s.T_body_sensor; }),
         pose_schema(required));
  add_range_limits(schema);
  schema.keys.push_back(self_mask());
  append(schema, "filter.", Lens<SensorConfig, FilterConfig>([](SensorConfig& s) -> FilterConfig& { return s.filter; }),
         filter_schema());
  schema.rules.push_back({{"filter.min_reflectance", "parameters.reflectance_shift"},
                          [](const SensorConfig& s) -> std::optional<Contradiction> {
                            if (s.filter.min_reflectance == 0 || s.projection.reflectance_shift != 0)
                              return std::nullopt;
                            return Contradiction{"parameters.reflectance_shift 12 or 16 with filter.min_reflectance",
                                                 "no reflectance_shift"};
                          }});
  return schema;
}

}  // namespace scree::config
