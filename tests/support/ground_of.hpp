#pragma once
// The rolling map as plain grids, made by hand.

#include <cmath>

#include "mapping/ground_layers.hpp"

namespace scree::test {

/// Every finite height is a cell measured by `hits` returns, with `noise_m2` in its mean.
inline mapping::GroundLayers ground_of(const Grid<float>& height_m, std::uint16_t hits = 100, float noise_m2 = 0.0F) {
  mapping::GroundLayers out;
  const int rows = height_m.rows(), columns = height_m.columns();
  out.height_m = height_m;
  out.noise_variance_m2.assign(rows, columns, noise_m2);
  out.hits.assign(rows, columns, 0);
  out.measured.assign(rows, columns, 0);
  for (std::size_t i = 0; i < height_m.size(); ++i) {
    out.measured[i] = std::isfinite(height_m[i]) ? 1 : 0;
    out.hits[i] = out.measured[i] != 0 ? hits : std::uint16_t{0};
  }
  return out;
}

}  // namespace scree::test
