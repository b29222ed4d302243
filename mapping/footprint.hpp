#pragma once
// A vehicle that stands on the cells of a grid.

#include <array>
#include <vector>

#include "core/grid.hpp"
#include "mapping/vehicle.hpp"

namespace scree::mapping {

/// The footprint at one heading, centred on a cell: which cells it touches, as offsets that are the same for every
/// centre, and how a plane lies on them.
struct Footprint {
  static constexpr int kWheels = 4;
  struct Part {
    CellIndex offset;
    float along_m = 0.0F, across_m = 0.0F;  ///< of the part's cell from the centre: forwards, to the left
  };

  std::array<Part, kWheels> wheels;
  std::vector<Part> belly;  ///< every cell between the wheels and the axles that no wheel stands on
  /// Of the least-squares plane through the heights z of the four wheels' cells: Σ level·z at the centre, Σ along·z its
  /// rise over run forwards, Σ across·z to the left.
  std::array<float, kWheels> level{}, along{}, across{};
};

/// Headings (k + ½)·π/count rad from the map's x axis, k = 0 … count − 1: half a turn is enough, for the limits of
/// pitch and roll are the same forwards and backwards, left and right. Wheels stand on the cells nearest to their
/// places, and the plane is that of the places of these cells, so rounding to cells tilts nothing. A direction in which
/// all wheels share a cell (a vehicle smaller than that) has no tilt.
std::vector<Footprint> footprints(const VehicleConfig& vehicle, double cell_m, int count);

/// The largest |offset| in x or y of any part of any of them.
int reach_cells(const std::vector<Footprint>& footprints);

}  // namespace scree::mapping
