// What of the energy planes an update has to do again.

#include <algorithm>
#include <cmath>

#include "fractal/energy_planes.hpp"
#include "fractal/plane_scroll.hpp"

namespace scree::fractal {

void EnergyPlanes::clear(int rows, int columns) {
  heights_.clear(rows, columns);
  for (auto* planes : {&energies_, &counts_})
    for (BoxSum& plane : *planes) plane.resize(rows, columns, radius_);
  for (BoxSum* plane : {&known_, &variance_, &inverse_hits_}) plane->resize(rows, columns, radius_);
  gone_ = {.all = true};
}

void EnergyPlanes::scroll(int rows, int columns) {
  if (rows == 0 && columns == 0) return;
  if (std::abs(rows) >= heights_.rows || std::abs(columns) >= heights_.columns)
    return clear(heights_.rows, heights_.columns);
  const auto move = [&](auto&& row_of) {
    scroll_plane<float>(row_of, heights_.rows, heights_.columns, rows, columns, 0.0F);
  };
  for (std::vector<float>* plane : {&heights_.height, &heights_.mask})
    move([&](int r) { return plane->data() + heights_.offset(r, 0); });
  for (auto* planes : {&energies_, &counts_})
    for (BoxSum& plane : *planes) move([&](int r) { return plane.row(r).data(); });
  for (BoxSum* plane : {&known_, &variance_, &inverse_hits_}) move([&](int r) { return plane->row(r).data(); });
  gone_.down = rows;
  gone_.right = columns;
}

/// Takes over one row and marks what differs. A cell's own values are compared, so nothing need be declared.
EnergyPlanes::RowSummary EnergyPlanes::take_row(const CellHeights& cells, int row) {
  const auto z = cells.height_m.row(row), noise = cells.variance_m2.row(row);
  const auto hits = cells.hits.row(row);
  float* height = heights_.height.data() + heights_.offset(row, 0);
  float* mask = heights_.mask.data() + heights_.offset(row, 0);
  const auto known = known_.row(row), variance = variance_.row(row), inverse = inverse_hits_.row(row);
  RowSummary summary;
  for (std::size_t begin = 0; begin < z.size(); begin += 64) {
    std::uint64_t new_height = 0, new_quantity = 0;
    for (std::size_t i = begin; i < std::min(begin + 64, z.size()); ++i) {
      const bool is_known = std::isfinite(z[i]);
      const float h = is_known ? z[i] : 0.0F, m = is_known ? 1.0F : 0.0F;
      const float v = is_known && noise[i] > 0.0F ? noise[i] : 0.0F;
      const float k = m / static_cast<float>(std::max<std::uint16_t>(hits[i], 1));
      new_height |= std::uint64_t{h != height[i] || m != mask[i]} << (i - begin);
      new_quantity |= std::uint64_t{v != variance[i] || k != inverse[i]} << (i - begin);
      height[i] = h;
      mask[i] = known[i] = m;
      variance[i] = v;
      inverse[i] = k;
      summary.largest_m = std::max(summary.largest_m, std::abs(h));
      summary.any_hits |= is_known && hits[i] > 0;
    }
    changed_heights_.row_words(row)[begin / 64] = new_height;
    changed_quantities_.row_words(row)[begin / 64] = new_quantity;
  }
  return summary;
}

void EnergyPlanes::find_changes(const CellHeights& cells) {
  const int rows = heights_.rows, columns = heights_.columns;
  for (BitPlane* plane : {&changed_heights_, &changed_quantities_}) plane->assign(rows, columns);
  RowSummary all;
  for (int r = 0; r < rows; ++r) {
    const RowSummary row = take_row(cells, r);
    all.largest_m = std::max(all.largest_m, row.largest_m);
    all.any_hits |= row.any_hits;
  }
  const Support support = all.any_hits ? Support::block : Support::centre_point;
  const auto rounding = static_cast<float>(rounding_variance_m2(all.largest_m));
  gone_.all |= support != support_ || rounding != rounding_variance_m2_;
  support_ = support;
  rounding_variance_m2_ = rounding;

  changed_increments_ = changed_heights_;
  changed_increments_.dilate(kIncrementReach);
  gone_.mark(kIncrementReach, changed_increments_);
  changed_windows_ = changed_heights_;
  changed_windows_.dilate(kIncrementReach);
  changed_windows_.add(changed_quantities_);
  changed_windows_.dilate(radius_);
  gone_.mark(kIncrementReach + radius_, changed_windows_);
  if (gone_.all) changed_windows_.set_box(0, rows, 0, columns);
  gone_ = {};
}

void EnergyPlanes::Gone::mark(int reach, BitPlane& plane) const {
  const int rows = plane.rows(), columns = plane.columns();
  if (down != 0) {
    plane.set_box(0, down > 0 ? reach : -down, 0, columns);
    plane.set_box(rows - (down > 0 ? down : reach), rows, 0, columns);
  }
  if (right != 0) {
    plane.set_box(0, rows, 0, right > 0 ? reach : -right);
    plane.set_box(0, rows, columns - (right > 0 ? right : reach), columns);
  }
}

}  // namespace scree::fractal
