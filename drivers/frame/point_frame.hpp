#pragma once
// Cartesian points of one frame, and what became of the pixels that are not among them.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree {

/// Every pixel of a frame is counted exactly once: pixels == points + sum of the rest.
struct PixelCounts {
  std::uint64_t pixels = 0;
  std::uint64_t points = 0;     ///< became points
  std::uint64_t no_return = 0;  ///< NaN, or the declared invalid code
  std::uint64_t untrusted_row = 0;
  std::uint64_t out_of_limits = 0;  ///< outside range_min_m … range_max_m, after the phase was resolved
  std::uint64_t self = 0;           ///< on the robot itself
  std::uint64_t speckle = 0;
  std::uint64_t mixed = 0;
  std::uint64_t ambiguous = 0;               ///< no interval could be told
  std::uint64_t assumed_first_interval = 0;  ///< among `points`: interval assumed, see PhasePolicy::first_interval
  std::uint64_t wrapped = 0;                 ///< among `points`: resolved to an interval beyond the first

  PixelCounts& operator+=(const PixelCounts& other);
};

/// Structure of arrays. Coordinates are map-frame metres relative to `anchor_map_m` (float keeps 0.1 mm within 1 km).
struct PointFrame {
  std::uint64_t sequence = 0;
  Time time;  ///< of the last row: the newest sample contained
  MonotonicTime received;
  Eigen::Vector3d anchor_map_m = Eigen::Vector3d::Zero();  ///< body position of the last row, in whole metres
  Pose T_map_body;                                         ///< of the last row
  std::vector<float> x_m, y_m, z_m;
  std::vector<float> range_m;
  std::vector<float> range_variance_m2;   ///< along the ray
  std::vector<float> direction_z;         ///< z of the unit ray in the map frame; see place_variance
  std::vector<std::uint32_t> row_begin;   ///< rows + 1 offsets: points of row r are [row_begin[r], row_begin[r+1])
  std::vector<Eigen::Vector3f> sensor_m;  ///< rows: sensor origin per row, relative to the anchor
  float angle_sigma_rad = 0.0F;           ///< of a ray's direction, about each of two axes
  PoseVariance pose_variance;             ///< of the last row; shared by all points
  PixelCounts counts;

  std::size_t size() const { return x_m.size(); }
};

/// Variance of a point's place, of its own errors alone (those of the pose are shared by the frame).
struct PlaceVariance {
  float height_m2 = 0.0F;      ///< along the map's z
  float horizontal_m2 = 0.0F;  ///< along one horizontal axis, the mean over all headings
};

/// The error along the ray has the standard deviation of the range; across it, on two axes, range · angle. Of the ray's
/// own vertical plane the part direction_z² (along) and 1 − direction_z² (across) is height.
inline PlaceVariance place_variance(float range_m, float range_variance_m2, float angle_sigma_rad, float direction_z) {
  const float across_m = range_m * angle_sigma_rad;
  const float across_m2 = across_m * across_m;
  const float up = direction_z * direction_z;
  return {up * range_variance_m2 + (1.0F - up) * across_m2,
          0.5F * ((1.0F - up) * range_variance_m2 + (1.0F + up) * across_m2)};
}

/// What is already known of the ground, for the phase resolver. Map frame, metres. Nothing where nothing is measured.
struct GroundHeight {
  double z_m = 0.0;
  double sigma_m = 0.0;
};
using GroundLookup = std::function<std::optional<GroundHeight>(double x_map_m, double y_map_m)>;

/// Range frame → points: phase resolution, range limits, self mask, speckle and mixed-pixel filter, then Cartesian
/// with each row's own pose. Deterministic for any executor. Keeps its buffers between frames (no allocation after
/// warm-up), and tables per sensor, which are rebuilt when the frame's projection or sensor object changes.
/// Cost: tests/bench/frame_bench.cpp. Rules and failure modes: docs/perceptron.md.
class PointConverter {
 public:
  PointConverter();
  PointConverter(PointConverter&&) noexcept;
  PointConverter& operator=(PointConverter&&) noexcept;
  ~PointConverter();

  /// `ground` may be empty. Fails (bad_data) when the frame contradicts its projection (sizes, row counts, missing
  /// sensor) or a pose is not finite; `out` is then unchanged.
  Status convert(const RangeFrame& frame, const GroundLookup& ground, Executor& executor, PointFrame& out);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace scree
