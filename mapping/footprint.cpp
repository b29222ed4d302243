#include "mapping/footprint.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree::mapping {

namespace {

struct Axes {
  double c, s;  // of the heading
  Footprint::Part part(CellIndex offset, double cell_m) const {
    const double x_m = offset.x * cell_m, y_m = offset.y * cell_m;
    return {offset, static_cast<float>(c * x_m + s * y_m), static_cast<float>(c * y_m - s * x_m)};
  }
  CellIndex nearest(double along_m, double across_m, double cell_m) const {
    return {static_cast<std::int32_t>(std::lround((c * along_m - s * across_m) / cell_m)),
            static_cast<std::int32_t>(std::lround((s * along_m + c * across_m) / cell_m))};
  }
};

void set_plane(Footprint& footprint) {
  Eigen::Matrix<double, Footprint::kWheels, 3> places;
  for (int i = 0; i < Footprint::kWheels; ++i) {
    const auto& wheel = footprint.wheels[static_cast<std::size_t>(i)];
    places.row(i) << 1.0, static_cast<double>(wheel.along_m), static_cast<double>(wheel.across_m);
  }
  const Eigen::Matrix<double, 3, Footprint::kWheels> plane = places.completeOrthogonalDecomposition().pseudoInverse();
  for (int i = 0; i < Footprint::kWheels; ++i) {
    const auto wheel = static_cast<std::size_t>(i);
    footprint.level[wheel] = static_cast<float>(plane(0, i));
    footprint.along[wheel] = static_cast<float>(plane(1, i));
    footprint.across[wheel] = static_cast<float>(plane(2, i));
  }
}

Footprint footprint_at(const VehicleConfig& vehicle, double cell_m, double heading_rad) {
  const Axes axes{std::cos(heading_rad), std::sin(heading_rad)};
  const double half_m = 0.5 * vehicle.wheelbase_m, side_m = 0.5 * vehicle.track_m;
  Footprint out;
  for (std::size_t i = 0; i < Footprint::kWheels; ++i)
    out.wheels[i] = axes.part(axes.nearest(i < 2 ? half_m : -half_m, i % 2 == 0 ? side_m : -side_m, cell_m), cell_m);
  set_plane(out);
  const int reach = static_cast<int>(std::ceil(std::hypot(half_m, side_m) / cell_m));
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const Footprint::Part part = axes.part({x, y}, cell_m);
      const bool under = std::abs(part.along_m) <= half_m && std::abs(part.across_m) <= side_m;
      const bool wheel = std::any_of(out.wheels.begin(), out.wheels.end(),
                                     [&](const Footprint::Part& w) { return w.offset == part.offset; });
      if (under && !wheel) out.belly.push_back(part);
    }
  return out;
}

}  // namespace

std::vector<Footprint> footprints(const VehicleConfig& vehicle, double cell_m, int count) {
  std::vector<Footprint> out;
  for (int k = 0; k < count; ++k) out.push_back(footprint_at(vehicle, cell_m, (k + 0.5) * std::numbers::pi / count));
  return out;
}

int reach_cells(const std::vector<Footprint>& footprints) {
  int reach = 0;
  const auto widen = [&](const Footprint::Part& part) {
    reach = std::max({reach, std::abs(part.offset.x), std::abs(part.offset.y)});
  };
  for (const Footprint& footprint : footprints) {
    std::for_each(footprint.wheels.begin(), footprint.wheels.end(), widen);
    std::for_each(footprint.belly.begin(), footprint.belly.end(), widen);
  }
  return reach;
}

}  // namespace scree::mapping
