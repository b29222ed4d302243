#pragma once
// A vehicle put onto ground: which of its limits it comes to. Written for itself, from the vehicle's description alone,
// so that the map's risk and cost can be judged by it.

#include "core/grid.hpp"
#include "mapping/vehicle.hpp"

namespace scree::bench {

/// Headings over half a turn: the vehicle is the same forwards and backwards.
inline constexpr int kTruthHeadings = 16;
/// A wheel rests on the mean height of a square of this side.
inline constexpr double kContact_m = 0.1;

/// Shares of the vehicle's limits that the ground takes; above 1 the limit is violated. NaN where the footprint holds
/// unknown ground.
struct LimitShares {
  float pitch = 0.0F, roll = 0.0F, clearance = 0.0F, step = 0.0F;
  float largest() const;  ///< NaN if any is
};

/// Rigid four wheels and a belly on a height field of square nodes.
class VehicleOnGround {
 public:
  /// height_m: NaN = unknown. Cost: some 150 operations a node.
  VehicleOnGround(const Grid<float>& height_m, double node_m, const mapping::VehicleConfig& vehicle);

  /// Centre in metres from node (0, 0), heading from the x axis (columns) to the y axis (rows).
  /// pitch, roll: of the least-squares plane through the four contacts. clearance: the highest node under the
  /// rectangle between the contacts, above that plane. step: largest difference between the contact height of a wheel
  /// and that of any node within a wheel radius. Contact height: mean over the square of kContact_m about the node;
  /// places are rounded to nodes. Cost: a look-up for every node of the belly.
  LimitShares at(double x_m, double y_m, double heading_rad) const;

 private:
  float contact_m(double x_m, double y_m) const;
  float step_m(double x_m, double y_m) const;
  float highest_above_plane_m(double x_m, double y_m, double cosine, double sine, double centre_m, double along,
                              double across) const;

  mapping::VehicleConfig vehicle_;
  double node_m_;
  Grid<float> height_, contact_, step_;
};

}  // namespace scree::bench
