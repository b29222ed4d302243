#include "drivers/frame/ray_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLooksDown = -0.02;    // z of a unit ray in the body frame
constexpr float kAnchorShare = 0.125F;  // of the ambiguity: chance that a reading of any phase lies within the bounds
constexpr float kAnchorFactor = 1.5F;   // beyond the narrowest bounds of the sensor
constexpr double kMaxLevelStep = 1.0;   // a level step beyond the range itself is horizon, not ground

struct BodyRay {
  Eigen::Vector3d origin_m;
  Eigen::Vector3d direction;
};

BodyRay body_ray(const RayTables& tables, int row, int column) {
  const Projection& p = *tables.projection;
  const Pose& mount = tables.sensor->T_body_sensor;
  const Eigen::Vector3d origin(p.origin_x_m(row, column), p.origin_y_m(row, column), p.origin_z_m(row, column));
  const Eigen::Vector3d direction(p.direction_x(row, column), p.direction_y(row, column), p.direction_z(row, column));
  return {mount * origin, mount.rotation * direction};
}

/// Slab test: the stretch of a ray inside the box, from the sensor outwards.
void fill_self(RayTables& tables, const BodyBox& box, int row, int column, const BodyRay& ray) {
  double near = 0.0;
  double far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin_m[axis];
    const double d = ray.direction[axis];
    if (d == 0.0) {
      if (o < box.min_m[axis] || o > box.max_m[axis]) far = -1.0;
      continue;
    }
    const double a = (box.min_m[axis] - o) / d;
    const double b = (box.max_m[axis] - o) / d;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  tables.self_near_m(row, column) = near <= far ? static_cast<float>(near) : kInfinity;
  tables.self_far_m(row, column) = near <= far ? static_cast<float>(far) : -kInfinity;
}

void fill_edge(float& grazing, float& level, const BodyRay& here, const BodyRay& there, double grazing_rad) {
  const double pitch_rad =
      std::atan2(here.direction.cross(there.direction).norm(), here.direction.dot(there.direction));
  grazing = static_cast<float>(pitch_rad / std::tan(grazing_rad));
  const double z_here = here.direction.z();
  const double z_there = there.direction.z();
  const double step = z_here < kLooksDown && z_there < kLooksDown ? z_here / z_there - 1.0 : 0.0;
  level = std::abs(step) <= kMaxLevelStep ? static_cast<float>(step) : 0.0F;
}

/// Ground of slope up to s passes through the body frame's z = 0 below the robot, give or take `height`: a ray that
/// looks down steeper than s meets it in [near, far]. Nothing hides behind it, and nothing returns from nearer than
/// range_min: where [range_min, far] is shorter than one ambiguity interval, a phase inside [near, far] has one
/// reading only.
void fill_ground(RayTables& tables, int row, int column, const BodyRay& ray) {
  const FilterConfig& filter = tables.sensor->filter;
  const double slope = std::tan(filter.anchor_slope_rad);
  const double across = std::hypot(ray.direction.x(), ray.direction.y());
  const double reach_m = filter.anchor_height_m + slope * std::hypot(ray.origin_m.x(), ray.origin_m.y());
  const double drop_slow = -ray.direction.z() - slope * across;
  const double drop_fast = -ray.direction.z() + slope * across;
  float& near = tables.ground_near_m(row, column);
  float& far = tables.ground_far_m(row, column);
  near = kInfinity;
  far = -kInfinity;
  if (ray.direction.z() < kLooksDown && ray.origin_m.z() > 0.0)
    tables.level_ground_m(row, column) = static_cast<float>(-ray.origin_m.z() / ray.direction.z());
  if (drop_slow <= 0.0 || ray.origin_m.z() <= 0.0) return;
  const double far_m = (ray.origin_m.z() + reach_m) / drop_slow;
  if (far_m - tables.projection->ambiguity_m >= filter.range_min_m) return;
  near = static_cast<float>(std::max((ray.origin_m.z() - reach_m) / drop_fast, filter.range_min_m));
  far = static_cast<float>(far_m);
}

/// Bounds become wide with distance, until any phase lies within them.
float anchor_width(const RayTables& tables) {
  float narrowest = kInfinity;
  for (std::size_t i = 0; i < tables.ground_near_m.size(); ++i)
    if (tables.ground_near_m[i] <= tables.ground_far_m[i])
      narrowest = std::min(narrowest, tables.ground_far_m[i] - tables.ground_near_m[i]);
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  return std::max(kAnchorShare * ambiguity, kAnchorFactor * narrowest);
}

void fill_image_row(RayTables& tables, int row) {
  const Projection& p = *tables.projection;
  const double grazing_rad = tables.sensor->filter.grazing_rad;
  for (int column = 0; column < p.columns; ++column) {
    const BodyRay here = body_ray(tables, row, column);
    if (column + 1 < p.columns)
      fill_edge(tables.grazing_right(row, column), tables.level_right(row, column), here,
                body_ray(tables, row, column + 1), grazing_rad);
    if (row + 1 < p.rows)
      fill_edge(tables.grazing_down(row, column), tables.level_down(row, column), here,
                body_ray(tables, row + 1, column), grazing_rad);
    if (p.ambiguity_m > 0.0) fill_ground(tables, row, column, here);
  }
}

}  // namespace

void RayTables::prepare(const std::shared_ptr<const Projection>& new_projection,
                        const std::shared_ptr<const SensorConfig>& new_sensor, Executor& executor) {
  if (projection == new_projection && sensor == new_sensor) return;
  projection = new_projection;
  sensor = new_sensor;
  quantum_m = 0.0F;
  for (const float count_m : projection->range_per_count_m) quantum_m = std::max(quantum_m, count_m);
  const int rows = projection->rows;
  const int columns = projection->columns;
  const auto& mask = sensor->filter.self_mask;
  const bool image = projection->is_image();
  if (mask)
    for (auto* table : {&self_near_m, &self_far_m}) table->assign(rows, columns, 0.0F);
  if (image)
    for (auto* table : {&grazing_right, &grazing_down, &level_right, &level_down}) table->assign(rows, columns, 0.0F);
  if (image && projection->ambiguity_m > 0.0)
    for (auto* table : {&ground_near_m, &ground_far_m, &level_ground_m}) table->assign(rows, columns, 0.0F);

  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      if (image) fill_image_row(*this, row);
      if (mask)
        for (int column = 0; column < columns; ++column)
          fill_self(*this, *mask, row, column, body_ray(*this, row, column));
    }
  });
  if (image && projection->ambiguity_m > 0.0) anchor_width_m = anchor_width(*this);
}

}  // namespace scree
