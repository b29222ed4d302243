#include "fractal/reconstruction/walk_hints.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {

WalkHints::WalkHints(const Delaunay& mesh, const PlanePoint& low, const PlanePoint& high)
    : mesh_(mesh), low_(low), high_(high), triangle_(1, 0) {
  remake();
}

std::size_t WalkHints::bucket(const PlanePoint& p) const {
  const auto place = [](double at, double low, double high, int count) {
    const double share = high > low ? (at - low) / (high - low) : 0.0;
    return static_cast<std::size_t>(std::clamp(share * count, 0.0, count - 1.0));
  };
  return place(p.y, low_.y, high_.y, rows_) * static_cast<std::size_t>(columns_) +
         place(p.x, low_.x, high_.x, columns_);
}

void WalkHints::added(const PlanePoint& p) {
  triangle_[bucket(p)] = mesh_.star()[0];
  if (mesh_.vertex_count() >= 2 * made_at_) remake();
}

/// Bucket by bucket, rows in alternate directions: each walk starts next door.
void WalkHints::remake() {
  made_at_ = mesh_.vertex_count();
  const double width = std::max(high_.x - low_.x, 1e-9), height = std::max(high_.y - low_.y, 1e-9);
  const double buckets = std::max(1.0, made_at_ / 2.0);
  columns_ = std::max(1, static_cast<int>(std::sqrt(std::min(buckets * width / height, buckets * buckets))));
  rows_ = std::max(1, static_cast<int>(buckets / columns_));
  int near = triangle_[0];
  triangle_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_));
  for (int r = 0; r < rows_; ++r)
    for (int i = 0; i < columns_; ++i) {
      const int c = r % 2 == 0 ? i : columns_ - 1 - i;
      near = mesh_.locate({low_.x + (c + 0.5) / columns_ * width, low_.y + (r + 0.5) / rows_ * height}, near);
      triangle_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] = near;
    }
}

}  // namespace scree::fractal
