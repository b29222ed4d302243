#include "drivers/frame/projection.hpp"

#include <fmt/format.h>
#include <utility>

namespace scree {
namespace {

constexpr std::pair<ProjectionKind, const char*> kKindNames[] = {
    {ProjectionKind::perceptron_usf, "perceptron_usf"},
    {ProjectionKind::perceptron_cmu, "perceptron_cmu"},
    {ProjectionKind::spherical, "spherical"},
    {ProjectionKind::pinhole, "pinhole"},
    {ProjectionKind::cloud, "cloud"},
};

std::shared_ptr<Projection> empty_tables(const ProjectionConfig& config) {
  auto tables = std::make_shared<Projection>();
  tables->config = config;
  tables->rows = config.rows;
  tables->columns = config.columns;
  tables->ambiguity_m = config.ambiguity_m;
  for (Grid<float>* table :
       {&tables->origin_x_m, &tables->origin_y_m, &tables->origin_z_m, &tables->direction_x, &tables->direction_y,
        &tables->direction_z, &tables->range_offset_m, &tables->range_per_count_m})
    table->assign(config.rows, config.columns, 0.0F);
  return tables;
}

void store(Projection& tables, std::size_t i, const PixelRay& ray) {
  tables.origin_x_m[i] = static_cast<float>(ray.origin_m.x());
  tables.origin_y_m[i] = static_cast<float>(ray.origin_m.y());
  tables.origin_z_m[i] = static_cast<float>(ray.origin_m.z());
  tables.direction_x[i] = static_cast<float>(ray.direction.x());
  tables.direction_y[i] = static_cast<float>(ray.direction.y());
  tables.direction_z[i] = static_cast<float>(ray.direction.z());
  tables.range_offset_m[i] = static_cast<float>(ray.range_offset_m);
  tables.range_per_count_m[i] = static_cast<float>(ray.range_per_count_m);
}

}  // namespace

Result<std::shared_ptr<const Projection>> make_projection(const ProjectionConfig& config, int rows, int columns) {
  if (config.kind == ProjectionKind::cloud)
    return Error{ErrorKind::bad_data, "projection cloud: expected points (make_cloud_projection), found an image"};
  auto complete = complete_projection(config, rows, columns);
  if (!complete) return complete.error();
  auto tables = empty_tables(*complete);
  std::size_t i = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) store(*tables, i++, pixel_ray(*complete, r, c));
  return std::shared_ptr<const Projection>(std::move(tables));
}

std::shared_ptr<const Projection> make_cloud_projection(const std::vector<Eigen::Vector3f>& points_sensor) {
  ProjectionConfig config;
  config.kind = ProjectionKind::cloud;
  config.rows = 1;
  config.columns = static_cast<int>(points_sensor.size());
  config.trusted_rows = 1;
  config.ambiguity_m = 0.0;
  auto tables = empty_tables(config);
  for (std::size_t i = 0; i < points_sensor.size(); ++i) {
    const Eigen::Vector3d point = points_sensor[i].cast<double>();
    const double range_m = point.norm();
    PixelRay ray;
    ray.direction = range_m > 0.0 ? Eigen::Vector3d(point / range_m) : Eigen::Vector3d::UnitX();
    ray.range_offset_m = range_m;
    ray.range_per_count_m = 0.0;
    store(*tables, i, ray);
  }
  return tables;
}

const char* to_string(ProjectionKind kind) {
  for (const auto& [known, name] : kKindNames)
    if (known == kind) return name;
  return "unknown";
}

Result<ProjectionKind> parse_projection_kind(const std::string& name) {
  std::string names;
  for (const auto& [kind, known] : kKindNames) {
    if (name == known) return kind;
    names += (names.empty() ? "" : " | ") + std::string(known);
  }
  return Error{ErrorKind::bad_data, fmt::format("projection: expected {}, found '{}'", names, name)};
}

}  // namespace scree
