#pragma once
// What the pixels of a surface say about its ambiguity interval. docs/perceptron.md explains the votes.

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/frame/pixel_state.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/ray_tables.hpp"
#include "drivers/frame/row_poses.hpp"
#include "drivers/frame/surfaces.hpp"

namespace scree {

/// Sums over points of the body frame, for the least-squares plane z = a + b·x + c·y.
struct PlaneSums {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(const Eigen::Vector3f& point_m);
  /// √(b² + c²); 0 where the points span no area.
  double slope() const;
};

/// Votes of one surface for the interval of its root pixel, −kBins/2 … kBins/2 − 1.
struct SurfaceEvidence {
  static constexpr int kBins = 16;
  using Bins = std::array<std::int32_t, kBins>;

  std::int32_t root = 0;
  std::int32_t size = 0;
  std::int32_t visited = 0;
  bool twisted = false;    ///< two ways through the surface disagree about the intervals between their ends
  Bins ground{};           ///< pixels that read between the bounds of ground within reach, RayTables::ground_near_m
  Bins anchor{};           ///< those of them whose bounds are narrow: RayTables::anchors
  PlaneSums anchor_plane;  ///< of the points that the anchor votes stand for
  std::int32_t asked = 0;  ///< pixels whose bounds are narrow, whatever they read
  Bins mapped{};           ///< asked pixels that lie on mapped ground in this interval and in no other
  Bins covered{};          ///< asked pixels whose candidate in this interval lies over or under mapped ground

  static bool representable(int root_interval) { return root_interval >= -kBins / 2 && root_interval < kBins / 2; }
  static std::size_t bin(int root_interval) { return static_cast<std::size_t>(root_interval + kBins / 2); }
};

class PhaseEvidence {
 public:
  static constexpr int kNoVote = 127;
  static constexpr int kFirstCandidate = -1;  ///< a standoff lets the count wrap below the first interval

  /// `ground` may be empty. `range_m` is modulo the ambiguity.
  void collect(const RayTables& tables, const RowPoses& poses, const GroundLookup& ground, const Surfaces& surfaces,
               const Grid<PixelState>& state, const Grid<float>& range_m);

  const std::vector<SurfaceEvidence>& surfaces() const { return surfaces_; }
  /// Index into surfaces() of a kept pixel's surface.
  std::size_t surface_of(std::int32_t root) const { return static_cast<std::size_t>(index_of_root_[root]); }
  /// The interval that pixel i's own evidence speaks for, or kNoVote.
  int vote(std::size_t i) const { return vote_[i]; }

 private:
  SurfaceEvidence& evidence_of(const Surfaces& surfaces, std::int32_t root);
  void vote_by_ground(const RayTables& tables, std::size_t i, float range_m, int relative, SurfaceEvidence& evidence);
  void vote_by_map(const RayTables& tables, const RowPoses& poses, const GroundLookup& ground, int row, std::size_t i,
                   float range_m, int relative, SurfaceEvidence& evidence);

  std::vector<SurfaceEvidence> surfaces_;
  std::vector<std::int32_t> index_of_root_;
  std::vector<std::int8_t> vote_;
  Eigen::Matrix3f body_rotation_ = Eigen::Matrix3f::Identity();  ///< of the sensor's axes
};

}  // namespace scree
