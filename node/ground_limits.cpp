#include "node/ground_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree::node {
namespace {

constexpr double kSpacing_m = 0.05;  // between the points of the ground that are looked at
constexpr int kHeadings = 90;        // over half a turn: within 1° of the true one
constexpr double kMoved_m = 0.01;
constexpr double kTurned_rad = 0.0175;

double heading_of(const Pose& pose) {
  const Eigen::Vector3d forward = pose.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

/// The vehicle is the same forwards and backwards.
std::size_t heading_bin(double heading_rad) {
  const double half_turns = heading_rad / std::numbers::pi;
  const double share = half_turns - std::floor(half_turns);
  return std::min<std::size_t>(static_cast<std::size_t>(share * kHeadings), kHeadings - 1);
}

}  // namespace

GroundLimits::GroundLimits(const drivers::Terrain& terrain, const mapping::VehicleConfig& vehicle)
    : terrain_(terrain), vehicle_(vehicle), footprints_(mapping::footprints(vehicle, kSpacing_m, kHeadings)) {}

void GroundLimits::add(const Pose& T_map_body) {
  if (last_) {
    const double moved_m = (T_map_body.translation_m - last_->translation_m).norm();
    path_m_ += moved_m;
    if (violated_) violated_m_ += moved_m;
  }
  last_ = T_map_body;
  if (last_judged_ && (T_map_body.translation_m - last_judged_->translation_m).norm() < kMoved_m &&
      T_map_body.rotation.angularDistance(last_judged_->rotation) < kTurned_rad)
    return;
  last_judged_ = T_map_body;
  ++judged_;
  const auto here = judge(T_map_body);
  if (!here) {
    ++without_;
    violated_ = false;
    return;
  }
  met_.pitch_rad = std::max(met_.pitch_rad, here->pitch_rad);
  met_.roll_rad = std::max(met_.roll_rad, here->roll_rad);
  met_.step_m = std::max(met_.step_m, here->step_m);
  met_.belly_m = std::max(met_.belly_m, here->belly_m);
  violated_ = here->pitch_rad > vehicle_.max_pitch_rad || here->roll_rad > vehicle_.max_roll_rad ||
              here->step_m > vehicle_.max_step_m || here->belly_m > vehicle_.clearance_m;
}

std::optional<LimitsMet> GroundLimits::judge(const Pose& T_map_body) const {
  const mapping::Footprint& footprint = footprints_[heading_bin(heading_of(T_map_body))];
  const double x_m = T_map_body.translation_m.x(), y_m = T_map_body.translation_m.y();
  double level_m = 0.0, along = 0.0, across = 0.0;
  LimitsMet here;
  for (std::size_t i = 0; i < footprint.wheels.size(); ++i) {
    const CellIndex offset = footprint.wheels[i].offset;
    const double wheel_x = x_m + offset.x * kSpacing_m, wheel_y = y_m + offset.y * kSpacing_m;
    const double z = contact_m(wheel_x, wheel_y);
    level_m += static_cast<double>(footprint.level[i]) * z;
    along += static_cast<double>(footprint.along[i]) * z;
    across += static_cast<double>(footprint.across[i]) * z;
    here.step_m = std::max(here.step_m, step_m(wheel_x, wheel_y, z));
  }
  here.pitch_rad = std::abs(std::atan(along));
  here.roll_rad = std::abs(std::atan(across));
  for (const auto& part : footprint.belly) {
    const double z = terrain_.height_m(x_m + part.offset.x * kSpacing_m, y_m + part.offset.y * kSpacing_m);
    const double plane_m =
        level_m + along * static_cast<double>(part.along_m) + across * static_cast<double>(part.across_m);
    if (std::isnan(z)) return std::nullopt;
    here.belly_m = std::max(here.belly_m, z - plane_m);
  }
  if (!std::isfinite(level_m + along + across)) return std::nullopt;
  return here;
}

/// Mean height of a square of 0.1 m, bilinear between points 0.05 m apart.
double GroundLimits::contact_m(double x_m, double y_m) const {
  double sum = 0.0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      sum +=
          (i == 0 ? 0.5 : 0.25) * (j == 0 ? 0.5 : 0.25) * terrain_.height_m(x_m + i * kSpacing_m, y_m + j * kSpacing_m);
  return sum;
}

/// Largest change to a contact height within a wheel's radius; unknown ground does not count.
double GroundLimits::step_m(double x_m, double y_m, double contact) const {
  const int reach = static_cast<int>(vehicle_.wheel_radius_m / kSpacing_m + 1e-9);
  double step = 0.0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j) {
      if (std::hypot(i, j) * kSpacing_m > vehicle_.wheel_radius_m + 1e-9) continue;
      const double change = std::abs(contact_m(x_m + i * kSpacing_m, y_m + j * kSpacing_m) - contact);
      if (change > step) step = change;  // false for NaN
    }
  return step;
}

}  // namespace scree::node
