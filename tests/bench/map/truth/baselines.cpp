#include "tests/bench/map/truth/baselines.hpp"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/bench/map/truth/vehicle_truth.hpp"

namespace scree::bench {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Means of the known cells of each 2 × 2.
Grid<float> halved(const Grid<float>& z) {
  Grid<float> out((z.rows() + 1) / 2, (z.columns() + 1) / 2, kUnknown);
  for (int r = 0; r < out.rows(); ++r)
    for (int c = 0; c < out.columns(); ++c) {
      float sum = 0.0F, known = 0.0F;
      for (int k = 0; k < 4; ++k) {
        const int row = 2 * r + k / 2, column = 2 * c + k % 2;
        if (!z.contains(row, column) || std::isnan(z(row, column))) continue;
        sum += z(row, column);
        known += 1.0F;
      }
      if (known > 0.0F) out(r, c) = sum / known;
    }
  return out;
}

/// Over-relaxed Gauss–Seidel on the cells that `known` leaves open.
void relax(const Grid<float>& known, Grid<float>& z) {
  constexpr int kMostSweeps = 400;
  constexpr float kOver = 1.8F, kEnough_m = 1e-4F;
  float largest = 1.0F;
  for (int sweep = 0; sweep < kMostSweeps && largest > kEnough_m; ++sweep) {
    largest = 0.0F;
    for (int r = 0; r < z.rows(); ++r)
      for (int c = 0; c < z.columns(); ++c) {
        if (!std::isnan(known(r, c))) continue;
        const float up = z(std::max(r - 1, 0), c), down = z(std::min(r + 1, z.rows() - 1), c);
        const float left = z(r, std::max(c - 1, 0)), right = z(r, std::min(c + 1, z.columns() - 1));
        const float change = 0.25F * (up + down + left + right) - z(r, c);
        z(r, c) += kOver * change;
        largest = std::max(largest, std::abs(change));
      }
  }
}

struct Offset {
  int row, column;
};

std::vector<Offset> disc(double radius_cells) {
  std::vector<Offset> out;
  const int reach = static_cast<int>(radius_cells + 1e-9);
  for (int r = -reach; r <= reach; ++r)
    for (int c = -reach; c <= reach; ++c)
      if (r * r + c * c <= radius_cells * radius_cells + 1e-9) out.push_back({r, c});
  return out;
}

/// Highest known value of the disc.
Grid<float> highest(const Grid<float>& z, double radius_cells) {
  Grid<float> high = z;
  for (const auto [dr, dc] : disc(radius_cells))
    for (int r = std::max(0, -dr); r < z.rows() - std::max(0, dr); ++r)
      for (int c = std::max(0, -dc); c < z.columns() - std::max(0, dc); ++c)
        high(r, c) = std::fmax(high(r, c), z(r + dr, c + dc));
  return high;
}

struct PlaneFit {
  double slope_rad = 0.0, rms_m = 0.0;
};

PlaneFit fit_plane(const Grid<float>& z, double cell_m, const std::vector<Offset>& offsets, int row, int column) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0, n = 0.0;
  for (const auto [dr, dc] : offsets) {
    if (!z.contains(row + dr, column + dc) || std::isnan(z(row + dr, column + dc))) continue;
    const Eigen::Vector3d place(dc * cell_m, dr * cell_m, 1.0);
    const double height = static_cast<double>(z(row + dr, column + dc) - z(row, column));
    normal += place * place.transpose();
    right += place * height;
    squares += height * height;
    n += 1.0;
  }
  if (n < 4.0) return {};
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  return {std::atan(plane.head<2>().norm()), std::sqrt(std::max(0.0, (squares - plane.dot(right)) / n))};
}

}  // namespace

Grid<float> smooth_fill(const Grid<float>& height_m) {
  const bool any = std::any_of(height_m.begin(), height_m.end(), [](float z) { return !std::isnan(z); });
  if (!any || height_m.size() == 1) return height_m;
  const Grid<float> coarse = smooth_fill(halved(height_m));
  Grid<float> out = height_m;
  for (int r = 0; r < out.rows(); ++r)
    for (int c = 0; c < out.columns(); ++c)
      if (std::isnan(out(r, c))) out(r, c) = coarse(r / 2, c / 2);
  relax(height_m, out);
  return out;
}

Grid<float> relief(const Grid<float>& height_m, double cell_m, double radius_m) {
  Grid<float> negative = height_m;
  for (float& z : negative) z = -z;
  Grid<float> high = highest(height_m, radius_m / cell_m);
  const Grid<float> low = highest(negative, radius_m / cell_m);
  for (std::size_t i = 0; i < high.size(); ++i) high[i] += low[i];
  return high;
}

Grid<float> relief_score(Grid<float> relief_m) {
  for (float& value : relief_m) value /= value + 0.2F;
  return relief_m;
}

Grid<float> plane_hazard(const Grid<float>& height_m, double cell_m, const PlaneRules& rules) {
  const auto slope_disc = disc(rules.slope_radius_m / cell_m), rough_disc = disc(rules.roughness_radius_m / cell_m);
  const Grid<float> steps = highest(relief(height_m, cell_m, rules.step_radius_m), rules.step_radius_m / cell_m);
  const double weights = rules.slope_weight + rules.step_weight + rules.roughness_weight;
  Grid<float> out(height_m.rows(), height_m.columns(), kUnknown);
  for (int r = 0; r < out.rows(); ++r)
    for (int c = 0; c < out.columns(); ++c) {
      if (std::isnan(height_m(r, c))) continue;
      const double slope = fit_plane(height_m, cell_m, slope_disc, r, c).slope_rad / rules.slope_critical_rad;
      const double rough = fit_plane(height_m, cell_m, rough_disc, r, c).rms_m / rules.roughness_critical_m;
      const double step = static_cast<double>(steps(r, c)) / rules.step_critical_m;
      out(r, c) =
          static_cast<float>((rules.slope_weight * std::min(slope, 1.0) + rules.step_weight * std::min(step, 1.0) +
                              rules.roughness_weight * std::min(rough, 1.0)) /
                             weights);
    }
  return out;
}

Grid<float> footprint_share(const Grid<float>& height_m, double cell_m, const mapping::VehicleConfig& vehicle) {
  const VehicleOnGround on_ground(height_m, cell_m, vehicle);
  Grid<float> out(height_m.rows(), height_m.columns(), kUnknown);
  for (int r = 0; r < out.rows(); ++r)
    for (int c = 0; c < out.columns(); ++c) {
      float worst = 0.0F;
      for (int k = 0; k < kTruthHeadings && !std::isnan(worst); ++k) {
        const float share = on_ground.at(c * cell_m, r * cell_m, std::numbers::pi * k / kTruthHeadings).largest();
        worst = std::isnan(share) || share > worst ? share : worst;
      }
      out(r, c) = worst;
    }
  return out;
}

}  // namespace scree::bench
