#include "fractal/reconstruction/barycentre_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.hpp"
#include "fractal/reconstruction/local_kriging.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kPlaceStream = 0x6261727963656e74;   // "barycent"
constexpr std::uint64_t kHeightStream = 0x6261727968656967;  // "baryheig"
constexpr std::int64_t kTriesPerPoint = 50;
constexpr double kLeastDistance = 1e-6;  // cells

std::int32_t half(std::int64_t number, int which) {
  return static_cast<std::int32_t>(number >> (32 * which));
}

/// The box of the points, cut to the grid's.
PlanePoint corner(const Delaunay& mesh, const SurfaceGrid& grid, bool high) {
  PlanePoint low{1e300, 1e300}, top{-1e300, -1e300};
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const PlanePoint& p = mesh.point(v);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    top = {std::max(top.x, p.x), std::max(top.y, p.y)};
  }
  if (high) return {std::min(top.x, grid.columns - 0.5), std::min(top.y, grid.rows - 0.5)};
  return {std::max(low.x, -0.5), std::max(low.y, -0.5)};
}

std::vector<double> repeated_heights(const std::vector<double>& z, int times) {
  std::vector<double> heights;
  heights.reserve(z.size() * static_cast<std::size_t>(times));
  for (const double height : z) heights.insert(heights.end(), static_cast<std::size_t>(times), height);
  return heights;
}

}  // namespace

BarycentreRefinement::BarycentreRefinement(TriangulatedSamples samples, const SurfaceRequest& request,
                                           const BarycentreOptions& options, int realisations)
    : request_(request),
      options_(options),
      realisations_(realisations),
      mesh_(std::move(samples.mesh)),
      heights_(repeated_heights(samples.z_m, realisations)),
      low_(corner(mesh_, request.grid, false)),
      high_(corner(mesh_, request.grid, true)),
      hints_(mesh_, low_, high_),
      spread_(static_cast<std::size_t>(realisations)) {}

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

bool BarycentreRefinement::insert(const PlanePoint& p, int triangle, BarycentreLaw law) {
  const std::array<int, 3> corners = mesh_.triangle(triangle).vertex;
  for (const int corner : corners)  // beside a vertex there is nothing to add
    if (std::abs(mesh_.point(corner).x - p.x) + std::abs(mesh_.point(corner).y - p.y) < kLeastDistance) return false;
  const auto [vertex, added] = mesh_.insert(p, triangle);
  if (!added) return false;
  if (law == BarycentreLaw::neighbours)
    raise_by_neighbours(vertex);
  else
    raise_by_corners(vertex, corners, law);
  hints_.added(p);
  return true;
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

std::int64_t BarycentreRefinement::refine(std::int64_t count) {
  mesh_.reserve(static_cast<std::size_t>(mesh_.vertex_count() + count));
  heights_.reserve(static_cast<std::size_t>(mesh_.vertex_count() + count) * static_cast<std::size_t>(realisations_));
  if (!(low_.x < high_.x && low_.y < high_.y)) return 0;
  std::int64_t done = 0;
  for (std::int64_t i = 0; done < count && i < kTriesPerPoint * count + 1000; ++i) {
    if (options_.law == BarycentreLaw::published && (done == 0 || mesh_.vertex_count() >= 2 * stage_begin_))
      measure_spread();
    const auto words = random_words(request_.seed, kPlaceStream, half(i, 0), half(i, 1));
    const PlanePoint place{low_.x + (high_.x - low_.x) * to_uniform(words[0]),
                           low_.y + (high_.y - low_.y) * to_uniform(words[1])};
    const int t = mesh_.locate(place, hints_.at(place));
    if (mesh_.is_ghost(t)) continue;
    const auto& [a, b, c] = mesh_.triangle(t).vertex;
    const PlanePoint &pa = mesh_.point(a), &pb = mesh_.point(b), &pc = mesh_.point(c);
    done += insert({(pa.x + pb.x + pc.x) / 3.0, (pa.y + pb.y + pc.y) / 3.0}, t, options_.law);
    if (request_.on_progress && done % 65536 == 0)
      request_.on_progress(static_cast<double>(done) / static_cast<double>(count));
  }
  return done;
}

void BarycentreRefinement::insert_cell_centres() {
  const auto columns = static_cast<std::int64_t>(request_.grid.columns), cells = columns * request_.grid.rows;
  const BarycentreLaw centres_law =  // equal weights are for barycentres alone
      options_.law == BarycentreLaw::neighbours ? BarycentreLaw::neighbours : BarycentreLaw::conditional;
  std::int64_t step = std::max<std::int64_t>(1, static_cast<std::int64_t>(0.6180339887 * static_cast<double>(cells)));
  while (std::gcd(step, cells) != 1) ++step;  // every cell once, spread evenly at all times
  for (std::int64_t i = 0, cell = 0; i < cells; ++i, cell = (cell + step) % cells) {
    const PlanePoint p{static_cast<double>(cell % columns), static_cast<double>(cell / columns)};
    const int t = mesh_.locate(p, hints_.at(p));
    if (!mesh_.is_ghost(t)) insert(p, t, centres_law);
  }
}

void BarycentreRefinement::rasterise(int k, Grid<float>& out) const {
  const auto point = [&](int v) { return SurfacePoint{mesh_.point(v).x, mesh_.point(v).y, heights(v)[k]}; };
  for (int t = 0; t < mesh_.triangle_count(); ++t) {
    if (mesh_.is_ghost(t)) continue;
    const auto& [a, b, c] = mesh_.triangle(t).vertex;
    rasterise_triangle(point(a), point(b), point(c), out);
  }
}

}  // namespace scree::fractal
