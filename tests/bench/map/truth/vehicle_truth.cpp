#include "tests/bench/map/truth/vehicle_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace scree::bench {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Mean over the square of (2·reach+1)² nodes, its outermost ones at half weight; NaN where any is.
Grid<float> square_means(const Grid<float>& z, int reach) {
  if (reach == 0) return z;
  Grid<float> rows(z.rows(), z.columns(), kUnknown), out = rows;
  const auto weight = [reach](int k) { return (std::abs(k) == reach ? 0.25F : 0.5F) / static_cast<float>(reach); };
  for (int r = 0; r < z.rows(); ++r)
    for (int c = reach; c + reach < z.columns(); ++c) {
      float sum = 0.0F;
      for (int k = -reach; k <= reach; ++k) sum += weight(k) * z(r, c + k);
      rows(r, c) = sum;
    }
  for (int r = reach; r + reach < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      float sum = 0.0F;
      for (int k = -reach; k <= reach; ++k) sum += weight(k) * rows(r + k, c);
      out(r, c) = sum;
    }
  return out;
}

/// Largest |difference| to a node within `radius` nodes; unknown ones do not count, an unknown centre is unknown.
Grid<float> largest_changes(const Grid<float>& z, double radius) {
  Grid<float> high = z, low = z;
  const int reach = static_cast<int>(radius + 1e-9);
  for (int dr = -reach; dr <= reach; ++dr)
    for (int dc = -reach; dc <= reach; ++dc) {
      if (dr * dr + dc * dc > radius * radius + 1e-9) continue;
      for (int r = std::max(0, -dr); r < z.rows() - std::max(0, dr); ++r)
        for (int c = std::max(0, -dc); c < z.columns() - std::max(0, dc); ++c) {
          const float other = z(r + dr, c + dc);
          high(r, c) = other > high(r, c) ? other : high(r, c);
          low(r, c) = other < low(r, c) ? other : low(r, c);
        }
    }
  Grid<float> out(z.rows(), z.columns());
  for (std::size_t i = 0; i < z.size(); ++i) out[i] = std::max(high[i] - z[i], z[i] - low[i]);
  return out;
}

}  // namespace

float LimitShares::largest() const {
  const float sum = pitch + roll + clearance + step;
  return std::isnan(sum) ? kUnknown : std::max({pitch, roll, clearance, step});
}

VehicleOnGround::VehicleOnGround(const Grid<float>& height_m, double node_m, const mapping::VehicleConfig& vehicle)
    : vehicle_(vehicle),
      node_m_(node_m),
      height_(height_m),
      contact_(square_means(height_m, static_cast<int>(std::lround(0.5 * kContact_m / node_m - 1e-9)))),
      step_(largest_changes(contact_, vehicle.wheel_radius_m / node_m)) {}

LimitShares VehicleOnGround::at(double x_m, double y_m, double heading_rad) const {
  const double cosine = std::cos(heading_rad), sine = std::sin(heading_rad);
  std::array<double, 4> z{};  // front left, front right, rear left, rear right
  float step = 0.0F;
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const double along = (wheel < 2 ? 0.5 : -0.5) * vehicle_.wheelbase_m;
    const double across = (wheel % 2 == 0 ? 0.5 : -0.5) * vehicle_.track_m;
    const double wheel_x = x_m + along * cosine - across * sine, wheel_y = y_m + along * sine + across * cosine;
    z[wheel] = static_cast<double>(contact_m(wheel_x, wheel_y));
    const float here = step_m(wheel_x, wheel_y);
    step = std::isnan(here) || here > step ? here : step;
  }
  const double along = 0.5 * (z[0] + z[1] - z[2] - z[3]) / vehicle_.wheelbase_m;
  const double across = 0.5 * (z[0] + z[2] - z[1] - z[3]) / vehicle_.track_m;
  const double centre_m = 0.25 * (z[0] + z[1] + z[2] + z[3]);
  LimitShares out;
  out.pitch = static_cast<float>(std::atan(std::abs(along)) / vehicle_.max_pitch_rad);
  out.roll = static_cast<float>(std::atan(std::abs(across)) / vehicle_.max_roll_rad);
  out.step = step / static_cast<float>(vehicle_.max_step_m);
  out.clearance = std::max(0.0F, highest_above_plane_m(x_m, y_m, cosine, sine, centre_m, along, across)) /
                  static_cast<float>(vehicle_.clearance_m);
  return out;
}

float VehicleOnGround::contact_m(double x_m, double y_m) const {
  const int row = static_cast<int>(std::lround(y_m / node_m_)), column = static_cast<int>(std::lround(x_m / node_m_));
  return contact_.contains(row, column) ? contact_(row, column) : kUnknown;
}

float VehicleOnGround::step_m(double x_m, double y_m) const {
  const int row = static_cast<int>(std::lround(y_m / node_m_)), column = static_cast<int>(std::lround(x_m / node_m_));
  return step_.contains(row, column) ? step_(row, column) : kUnknown;
}

float VehicleOnGround::highest_above_plane_m(double x_m, double y_m, double cosine, double sine, double centre_m,
                                             double along, double across) const {
  const double half_length = 0.5 * vehicle_.wheelbase_m, half_width = 0.5 * vehicle_.track_m;
  const double reach = std::hypot(half_length, half_width);
  const int row_end = static_cast<int>(std::floor((y_m + reach) / node_m_));
  const int column_end = static_cast<int>(std::floor((x_m + reach) / node_m_));
  float highest = -std::numeric_limits<float>::infinity();
  for (int row = static_cast<int>(std::ceil((y_m - reach) / node_m_)); row <= row_end; ++row)
    for (int column = static_cast<int>(std::ceil((x_m - reach) / node_m_)); column <= column_end; ++column) {
      const double dx = column * node_m_ - x_m, dy = row * node_m_ - y_m;
      const double a = dx * cosine + dy * sine, b = dy * cosine - dx * sine;
      if (std::abs(a) > half_length || std::abs(b) > half_width) continue;
      if (!height_.contains(row, column)) return kUnknown;
      const float above = height_(row, column) - static_cast<float>(centre_m + along * a + across * b);
      if (std::isnan(above)) return kUnknown;
      highest = std::max(highest, above);
    }
  return highest;
}

}  // namespace scree::bench
