#include "mapping/alignment.hpp"

#include <algorithm>
#include <cmath>

namespace scree::mapping {

namespace {

// By this much two views of the same ground differ without any pose being wrong.
constexpr double kViewHeight_m = 0.002;
constexpr double kViewTilt_rad = 0.0006;
constexpr double kSignificant = 3.0;
constexpr double kTiltMemory_s = 5.0;
constexpr double kPlace_m = 0.006;
constexpr double kHeading_rad = 0.0015;
constexpr double kShiftChi2 = 16.3;  // 1 in 1000 by chance: a shift that slopes do not tell is none
constexpr double kHeadingMemory_s = 30.0;

/// The part of a disagreement that is the pose's, when views alone make one of `view` (rms) and it is known to
/// `variance`.
double share_of_pose(double found, double view, double variance) {
  return found * found / (found * found + 4.0 * (view * view + variance));
}

void forget(RollingGrid<MapCell>& map) {
  const LatticeWindow& window = map.window();
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column) map(row, column) = MapCell{};
}

}  // namespace

void Alignment::follow(const FrameFit& fit, double cell_m, Executor& executor, RollingGrid<MapCell>& map,
                       HeightPlane& left) {
  const bool jumped = fit.agreement == Agreement::jumped;
  const double height_m2 = kViewHeight_m * kViewHeight_m + fit.covariance(0, 0);
  const double tilt_rad2 = kViewTilt_rad * kViewTilt_rad + fit.covariance(1, 1) + fit.covariance(2, 2);
  const bool high = std::abs(left.height_m) > kSignificant * std::sqrt(height_m2);
  const bool tilted = left.slope.norm() > kSignificant * std::sqrt(tilt_rad2);
  if (!high && !tilted) return;
  HeightPlane step;
  step.centre_m = left.centre_m;
  if (high) step.height_m = left.height_m;
  if (tilted) step.slope = (jumped ? 1.0 : 1.0 - std::exp(-elapsed_s_ / kTiltMemory_s)) * left.slope;
  add_plane(step, static_cast<float>(kViewHeight_m * kViewHeight_m), cell_m, executor, map);
  left.height_m -= step.height_m;
  left.slope -= step.slope;
}

const PointFrame& Alignment::place(const PointFrame& points) {
  if (shift_.x_m == 0.0 && shift_.y_m == 0.0 && shift_.heading_rad == 0.0) return points;
  placed_ = points;  // buffers are kept
  const Eigen::Vector3f body = (points.T_map_body.translation_m - points.anchor_map_m).cast<float>();
  const auto c = static_cast<float>(std::cos(shift_.heading_rad)), s = static_cast<float>(std::sin(shift_.heading_rad));
  const auto dx = static_cast<float>(shift_.x_m), dy = static_cast<float>(shift_.y_m);
  const auto put_back = [&](float& x, float& y) {
    const float u = x - body.x() - dx, v = y - body.y() - dy;
    x = body.x() + c * u + s * v;
    y = body.y() - s * u + c * v;
  };
  for (std::size_t i = 0; i < placed_.size(); ++i) put_back(placed_.x_m[i], placed_.y_m[i]);
  for (Eigen::Vector3f& sensor : placed_.sensor_m) put_back(sensor.x(), sensor.y());
  return placed_;
}

bool Alignment::fit(const PointFrame& points, double cell_m, const RollingGrid<MapCell>& map,
                    const FrameReturns& frame) {
  const Eigen::Vector3d body_m = points.T_map_body.translation_m;
  const double moved_m = begun_ ? (body_m - body_m_).norm() : 0.0;
  fit_ = registration_.fit(frame, map, static_cast<float>(cell_m), body_m.head<2>(), moved_m);
  const PlanarShift& step = fit_.frame_beside_map;
  const bool beside = std::hypot(step.x_m, step.y_m) > kPlace_m, turned = std::abs(step.heading_rad) > kHeading_rad;
  if ((!beside && !turned) || fit_.shift_chi2 < kShiftChi2) return false;
  shift_.x_m += step.x_m;
  shift_.y_m += step.y_m;
  shift_.heading_rad += step.heading_rad;
  return true;
}

void Alignment::carry(double cell_m, RollingGrid<MapCell>& map) {
  shift_.heading_rad *= std::exp(-elapsed_s_ / kHeadingMemory_s);
  const CellIndex cells{static_cast<std::int32_t>(std::lround(shift_.x_m / cell_m)),
                        static_cast<std::int32_t>(std::lround(shift_.y_m / cell_m))};
  if (cells.x == 0 && cells.y == 0) return;
  map.relabel(cells);
  shift_.x_m -= cells.x * cell_m;
  shift_.y_m -= cells.y * cell_m;
}

AlignmentReport Alignment::align(const PointFrame& points, double cell_m, Executor& executor, RollingGrid<MapCell>& map,
                                 FrameReturns& frame) {
  const Eigen::Vector3d body_m = points.T_map_body.translation_m;
  elapsed_s_ = begun_ ? std::max(0.0, to_seconds(points.time - time_)) : 0.0;
  begun_ = true;
  body_m_ = body_m;
  time_ = points.time;

  const FrameFit& fit = fit_;
  AlignmentReport report;
  report.beside = shift_;
  report.agreement = fit.agreement;
  report.overlap = fit.overlap;
  report.height_m = fit.frame_less_map.height_m;
  report.tilt_rad = fit.frame_less_map.slope.norm();
  if (fit.agreement == Agreement::contradicts) {
    report.forgotten = ++contradictions_ >= kFramesToContradict;
    report.refused = !report.forgotten;
    if (report.forgotten) {
      forget(map);
      shift_ = {};
      contradictions_ = 0;
    }
    return report;
  }
  contradictions_ = 0;
  if (fit.agreement == Agreement::unknown) return report;
  HeightPlane left = fit.frame_less_map;
  left.height_m *= share_of_pose(left.height_m, kViewHeight_m, fit.covariance(0, 0));
  left.slope *= share_of_pose(left.slope.norm(), kViewTilt_rad, fit.covariance(1, 1) + fit.covariance(2, 2));
  follow(fit, cell_m, executor, map, left);
  subtract_plane(left, fit.covariance, map.window(), cell_m, frame);
  report.off = left;
  return report;
}

}  // namespace scree::mapping
