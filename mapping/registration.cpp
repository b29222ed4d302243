#include "mapping/registration.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr std::size_t kLeastOverlap = 40;
constexpr std::size_t kMostCells = 4096;
constexpr double kIndependent = 400.0;
constexpr int kIterations = 6;

// What a pose may have wrong against the last frame's.
constexpr double kPriorHeight_m = 0.05;
constexpr double kPriorShare = 0.03;  // of the way
constexpr double kPriorTilt_rad = 0.02;
constexpr double kPriorPlace_m = 0.02;
constexpr double kPriorHeading_rad = 0.02;
constexpr double kJumpSigmas = 5.0;

// A frame contradicts the map when fewer than this share of its innovations lie within this many of their own standard
// deviations, at least kContradiction_m, of the plane.
constexpr double kAgreeingShare = 0.5;
constexpr double kAgreeingSigmas = 5.0;
constexpr double kContradiction_m = 0.1;

/// Rise over run between the neighbours on both sides; 0 where one of them is not known.
double gradient(const RollingGrid<MapCell>& map, int row, int column, int dy, int dx, double cell_m) {
  const LatticeWindow& window = map.window();
  const bool inside = row - dy >= 0 && column - dx >= 0 && row + dy < window.rows && column + dx < window.columns;
  if (!inside) return 0.0;
  const MapCell &low = map(row - dy, column - dx), &high = map(row + dy, column + dx);
  if (!low.measured() || !high.measured()) return 0.0;
  return static_cast<double>(high.height_m - low.height_m) / (2.0 * cell_m);
}

double middle(std::vector<double>& values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void Registration::collect(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m,
                           const Eigen::Vector2d& body_m) {
  overlap_ = 0;
  for (const CellReturn& seen : frame.all()) overlap_ += map(seen.row, seen.column).measured() ? 1U : 0U;
  innovations_.clear();
  innovations_.reserve(kMostCells + 1);
  const std::size_t stride = overlap_ / kMostCells + 1;
  std::size_t i = 0;
  const LatticeWindow& window = map.window();
  for (const CellReturn& seen : frame.all()) {
    const MapCell& cell = map(seen.row, seen.column);
    if (!cell.measured() || i++ % stride != 0) continue;
    const GroundReturn& ground = seen.ground;
    const double variance_m2 = static_cast<double>(own_variance_m2(cell, cell_m) + own_variance_m2(ground, cell_m));
    const double side_m = static_cast<double>(cell_m);
    const double x_m = (window.min.x + seen.column + 0.5) * side_m - body_m.x();
    const double y_m = (window.min.y + seen.row + 0.5) * side_m - body_m.y();
    const double gx = gradient(map, seen.row, seen.column, 0, 1, side_m);
    const double gy = gradient(map, seen.row, seen.column, 1, 0, side_m);
    Innovation& innovation = innovations_.emplace_back();
    innovation.row << 1.0, x_m, y_m, -gx, -gy, gx * y_m - gy * x_m;
    innovation.z_m = static_cast<double>(ground.height_m) - static_cast<double>(cell.height_m);
    innovation.variance_m2 = variance_m2;
  }
}

double Registration::spread_about(const Row& solution) {
  magnitudes_.clear();
  magnitudes_.reserve(kMostCells + 1);
  for (const Innovation& i : innovations_) magnitudes_.push_back(std::abs(i.z_m - solution.dot(i.row)));
  return 1.4826 * middle(magnitudes_);
}

FrameFit Registration::fit(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m,
                           const Eigen::Vector2d& body_m, double moved_m) {
  collect(frame, map, cell_m, body_m);
  FrameFit out;
  out.overlap = overlap_;
  out.frame_less_map.centre_m = body_m;
  if (innovations_.size() < kLeastOverlap) return out;

  magnitudes_.clear();
  magnitudes_.reserve(kMostCells + 1);
  for (const Innovation& i : innovations_) magnitudes_.push_back(i.z_m);
  const double height_m = kPriorHeight_m + kPriorShare * moved_m, place_m = kPriorPlace_m + kPriorShare * moved_m;
  Row prior;
  prior << height_m, kPriorTilt_rad, kPriorTilt_rad, place_m, place_m, kPriorHeading_rad;
  prior = prior.cwiseAbs2();
  const double share = std::min(1.0, kIndependent / static_cast<double>(innovations_.size()));
  Row solution = Row::Zero();
  solution[0] = middle(magnitudes_);
  Eigen::Matrix<double, 6, 6> covariance;
  for (int k = 0; k < kIterations; ++k) {
    out.spread_m = spread_about(solution);
    Eigen::Matrix<double, 6, 6> information = prior.cwiseInverse().asDiagonal();
    Row right = Row::Zero();
    for (const Innovation& i : innovations_) {
      const double residual = i.z_m - solution.dot(i.row);
      const double scale_m2 = std::max(i.variance_m2, out.spread_m * out.spread_m);
      const double weight = share / (scale_m2 + residual * residual / 4.0);
      information.noalias() += weight * i.row * i.row.transpose();
      right += weight * i.z_m * i.row;
    }
    covariance = information.inverse();
    solution = covariance * right;
  }
  out.covariance = covariance.topLeftCorner<3, 3>();

  std::size_t agreeing = 0;
  for (const Innovation& i : innovations_) {
    const double limit_m = std::max(kContradiction_m, kAgreeingSigmas * std::sqrt(i.variance_m2));
    agreeing += std::abs(i.z_m - solution.dot(i.row)) <= limit_m ? 1U : 0U;
  }
  if (static_cast<double>(agreeing) < kAgreeingShare * static_cast<double>(innovations_.size())) {
    out.agreement = Agreement::contradicts;
    return out;
  }
  out.frame_less_map.height_m = solution[0];
  out.frame_less_map.slope = solution.segment<2>(1);
  out.frame_beside_map = {solution[3], solution[4], solution[5]};
  const Eigen::Vector3d shift = solution.tail<3>();
  const Eigen::Matrix3d shift_covariance = covariance.bottomRightCorner<3, 3>();
  out.shift_chi2 = shift.dot(shift_covariance.inverse() * shift);
  const double worst = solution.head<3>().cwiseAbs2().cwiseQuotient(prior.head<3>()).maxCoeff();
  out.agreement = worst > kJumpSigmas * kJumpSigmas ? Agreement::jumped : Agreement::registered;
  return out;
}

void add_plane(const HeightPlane& plane, float variance_m2, double cell_m, Executor& executor,
               RollingGrid<MapCell>& map) {
  const LatticeWindow& window = map.window();
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      const double y_m = (window.min.y + row + 0.5) * cell_m;
      for (int column = 0; column < window.columns; ++column) {
        const auto change_m = static_cast<float>(plane.at((window.min.x + column + 0.5) * cell_m, y_m));
        MapCell& cell = map(row, column);
        cell.ceiling_m += change_m;  // infinities stay
        cell.lip_m += change_m;
        cell.lowest_ceiling_m += change_m;
        cell.lowest_lip_m += change_m;
        if (!cell.measured()) continue;
        cell.height_m += change_m;
        cell.shared_variance_m2 += variance_m2;
      }
    }
  });
}

void subtract_plane(const HeightPlane& plane, const Eigen::Matrix3d& covariance, const LatticeWindow& window,
                    double cell_m, FrameReturns& frame) {
  for (CellReturn& seen : frame.all()) {
    const double x_m = (window.min.x + seen.column + 0.5) * cell_m, y_m = (window.min.y + seen.row + 0.5) * cell_m;
    const auto change_m = static_cast<float>(plane.at(x_m, y_m));
    const Eigen::Vector3d arm(1.0, x_m - plane.centre_m.x(), y_m - plane.centre_m.y());
    seen.ground.height_m -= change_m;
    seen.ground.bottom_m -= change_m;
    seen.ground.against_map_m2 = static_cast<float>(arm.dot(covariance * arm));
    seen.ground.shared_variance_m2 += seen.ground.against_map_m2;
  }
}

}  // namespace scree::mapping
