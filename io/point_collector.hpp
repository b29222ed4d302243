#pragma once
// Points in double precision on their way into a PointCloud.

#include <string>
#include <vector>

#include "io/point_cloud.hpp"

namespace scree::io {

/// Drops and counts non-finite points; moves the origin where float32 would lose the file's digits.
class PointCollector {
 public:
  void reserve(std::size_t count) { points_.reserve(count); }
  /// Coordinates as the file has them; an intensity that is no finite float becomes 0.
  void add(const Eigen::Vector3d& point, double intensity);
  /// `origin_m` is whole metres, the floor of the smallest coordinates, when some coordinate would be off by more than
  /// 0.1 mm in float32; else 0. Errors: bad_data (no finite point), with `name`.
  Result<PointCloud> finish(const std::string& name) &&;

 private:
  struct Point {
    Eigen::Vector3d position;
    float intensity;
  };
  std::vector<Point> points_;
  std::size_t dropped_ = 0;
};

}  // namespace scree::io
