// The heights of new points, one a realisation.

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/reconstruction/barycentre_refinement.hpp"
#include "fractal/reconstruction/local_kriging.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kHeightStream = 0x6261727968656967;  // "baryheig"

}  // namespace

FractalLaw BarycentreRefinement::law_of(const PlanePoint& p) const {
  if (options_.centres.empty()) return law_at(request_, p.x, p.y);
  const double x_m = (p.x + 0.5) * request_.grid.cell_m, y_m = (p.y + 0.5) * request_.grid.cell_m;
  const auto squared = [&](const InfluenceCentre& centre) {
    return (centre.x_m - x_m) * (centre.x_m - x_m) + (centre.y_m - y_m) * (centre.y_m - y_m);
  };
  return std::min_element(options_.centres.begin(), options_.centres.end(),
                          [&](const auto& a, const auto& b) { return squared(a) < squared(b); })
      ->law;
}

bool BarycentreRefinement::in_grid(const PlanePoint& p) const {
  return p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y;
}

/// var(mean of corners − corner) over the triangles of the grid as they are now; their mean is 0 by construction.
void BarycentreRefinement::measure_spread() {
  stage_begin_ = mesh_.vertex_count();
  std::fill(spread_.begin(), spread_.end(), 0.0);
  std::int64_t triangles = 0;
  for (int t = 0; t < mesh_.triangle_count(); ++t) {
    if (mesh_.is_ghost(t)) continue;
    const auto& [a, b, c] = mesh_.triangle(t).vertex;
    const PlanePoint &pa = mesh_.point(a), &pb = mesh_.point(b), &pc = mesh_.point(c);
    if (!in_grid({(pa.x + pb.x + pc.x) / 3.0, (pa.y + pb.y + pc.y) / 3.0})) continue;
    ++triangles;
    for (int k = 0; k < realisations_; ++k) {
      const double za = heights(a)[k], zb = heights(b)[k], zc = heights(c)[k], mean = (za + zb + zc) / 3.0;
      spread_[static_cast<std::size_t>(k)] +=
          (za - mean) * (za - mean) + (zb - mean) * (zb - mean) + (zc - mean) * (zc - mean);
    }
  }
  for (double& spread : spread_) spread /= 3.0 * std::max<double>(1.0, static_cast<double>(triangles));
}

/// Two realisations share a call of the generator.
std::array<double, 2> BarycentreRefinement::normals(int vertex, int k) const {
  return random_normals(request_.seed, kHeightStream + static_cast<std::uint64_t>(k / 2), vertex, 0);
}

void BarycentreRefinement::raise_by_corners(int vertex, const std::array<int, 3>& corners, BarycentreLaw kind) {
  const PlanePoint p = mesh_.point(vertex);
  const FractalLaw law = law_of(p);
  const TriangleVariogram v({mesh_.point(corners[0]), mesh_.point(corners[1]), mesh_.point(corners[2])}, p, law.hurst(),
                            law.rms_change_m(request_.grid.cell_m));
  TriangleLaw height = kind == BarycentreLaw::conditional ? conditional_law(v) : exact_mean_law(v);
  for (int k = 0; k < realisations_; k += 2) {
    const auto noise = normals(vertex, k);
    for (int i = k; i < std::min(k + 2, realisations_); ++i) {
      if (kind == BarycentreLaw::published) height = published_law(v, spread_[static_cast<std::size_t>(i)]);
      double z = std::sqrt(height.variance) * noise[static_cast<std::size_t>(i - k)];
      for (std::size_t j = 0; j < 3; ++j) z += height.weight[j] * heights(corners[j])[i];
      heights_.push_back(z);
    }
  }
}

void BarycentreRefinement::raise_by_neighbours(int vertex) {
  const PlanePoint p = mesh_.point(vertex);
  const FractalLaw law = law_of(p);
  std::array<int, kMaxLocalPoints> known;
  std::array<PlanePoint, kMaxLocalPoints> points;
  std::size_t count = 0;
  for (const int t : mesh_.star()) {  // a triangle of the star names one neighbour first; the new vertex last
    const int neighbour = mesh_.triangle(t).vertex[0];
    if (neighbour == Delaunay::kInfinite || count == kMaxLocalPoints) continue;
    known[count] = neighbour;
    points[count++] = mesh_.point(neighbour);
  }
  const LocalLaw height = local_law({points.data(), count}, p, law.hurst(), law.rms_change_m(request_.grid.cell_m));
  const double sd = std::sqrt(height.variance);
  for (int k = 0; k < realisations_; k += 2) {
    const auto noise = normals(vertex, k);
    for (int i = k; i < std::min(k + 2, realisations_); ++i) {
      double z = sd * noise[static_cast<std::size_t>(i - k)];
      for (std::size_t j = 0; j < count; ++j) z += height.weight[j] * heights(known[j])[i];
      heights_.push_back(z);
    }
  }
}

}  // namespace scree::fractal
