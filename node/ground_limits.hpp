#pragma once
// What the ground asked of a vehicle on the way that it took: judged on the true terrain, not on the map.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "drivers/terrain.hpp"
#include "mapping/footprint.hpp"

namespace scree::node {

/// Largest of each over the way. Definitions: docs/simulator.md.
struct LimitsMet {
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double step_m = 0.0;
  double belly_m = 0.0;  ///< highest ground under the belly above the plane of the wheels
};

class GroundLimits {
 public:
  /// `terrain` outlives this.
  GroundLimits(const drivers::Terrain& terrain, const mapping::VehicleConfig& vehicle);

  /// The next pose of the way. Judged when the body has moved by a centimetre or turned by a degree since the last.
  void add(const Pose& T_map_body);

  const LimitsMet& met() const { return met_; }
  double path_m() const { return path_m_; }                  ///< along the ground
  double violated_m() const { return violated_m_; }          ///< of path_m, where a limit was exceeded
  std::uint64_t judged() const { return judged_; }           ///< poses
  std::uint64_t without_ground() const { return without_; }  ///< poses with a hole or the edge under the footprint

 private:
  std::optional<LimitsMet> judge(const Pose& T_map_body) const;
  double contact_m(double x_m, double y_m) const;
  double step_m(double x_m, double y_m, double contact_m) const;

  const drivers::Terrain& terrain_;
  mapping::VehicleConfig vehicle_;
  std::vector<mapping::Footprint> footprints_;
  std::optional<Pose> last_judged_, last_;
  bool violated_ = false;
  LimitsMet met_;
  double path_m_ = 0.0, violated_m_ = 0.0;
  std::uint64_t judged_ = 0, without_ = 0;
};

}  // namespace scree::node
