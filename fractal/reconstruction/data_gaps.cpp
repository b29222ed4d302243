#include "fractal/reconstruction/data_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace scree::fractal {

int widest_gap_cells(const Grid<float>& height_m) {
  Grid<std::uint8_t> full(height_m.rows(), height_m.columns(), 0);
  for (std::size_t i = 0; i < full.size(); ++i) full[i] = std::isnan(height_m[i]) ? 0 : 1;
  int block = 1;
  while (full.size() > 1 && std::find(full.begin(), full.end(), 0) != full.end()) {
    Grid<std::uint8_t> coarse((full.rows() + 1) / 2, (full.columns() + 1) / 2, 0);
    for (int r = 0; r < full.rows(); ++r)
      for (int c = 0; c < full.columns(); ++c) coarse(r / 2, c / 2) |= full(r, c);
    full = std::move(coarse);
    block *= 2;
  }
  return block;
}

}  // namespace scree::fractal
