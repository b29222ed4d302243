#include "io/point_collector.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace scree::io {
namespace {

constexpr double kFloatLoss_m = 1e-4;
constexpr double kLargest_m = 1e12;  ///< beyond this no origin helps, and nothing on Earth is that far away

}  // namespace

void PointCollector::add(const Eigen::Vector3d& point, double intensity) {
  if (!point.allFinite() || point.cwiseAbs().maxCoeff() > kLargest_m) {
    ++dropped_;
    return;
  }
  const bool fits = std::abs(intensity) <= static_cast<double>(std::numeric_limits<float>::max());
  points_.push_back({point, fits ? static_cast<float>(intensity) : 0.0f});
}

Result<PointCloud> PointCollector::finish(const std::string& name) && {
  if (points_.empty())
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected at least one finite point, found {} points, none finite", name, dropped_)};
  Eigen::Vector3d min = points_.front().position;
  double loss_m = 0.0;
  for (const Point& point : points_) {
    min = min.cwiseMin(point.position);
    loss_m = std::max(loss_m, (point.position.cast<float>().cast<double>() - point.position).cwiseAbs().maxCoeff());
  }
  PointCloud cloud;
  cloud.dropped_non_finite = dropped_;
  if (loss_m > kFloatLoss_m) cloud.origin_m = min.array().floor();
  cloud.points.reserve(points_.size());
  for (const Point& point : points_) {
    Eigen::Vector4f& out = cloud.points.emplace_back();
    out << (point.position - cloud.origin_m).cast<float>(), point.intensity;
  }
  return cloud;
}

}  // namespace scree::io
