#include "fractal/reconstruction/barycentre_refinement.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/reconstruction/spatial_order.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kPlaceStream = 0x6261727963656e74;  // "barycent"
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

BarycentreRefinement::BarycentreRefinement(TriangulatedSamples&& samples, const SurfaceRequest& request,
                                           const BarycentreOptions& options, int realisations)
    : request_(request),
      options_(options),
      realisations_(realisations),
      mesh_(std::move(samples.mesh)),
      heights_(repeated_heights(samples.z_m, realisations)),
      low_(corner(mesh_, request.grid, false)),
      high_(corner(mesh_, request.grid, true)),
      spread_(static_cast<std::size_t>(realisations)) {}

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
  near_ = mesh_.star()[0];
  return true;
}

/// Growing by doubling would take up to three times the memory.
void BarycentreRefinement::reserve(std::int64_t more) {
  mesh_.reserve(static_cast<std::size_t>(mesh_.vertex_count() + more));
  heights_.reserve(static_cast<std::size_t>(mesh_.vertex_count() + more) * static_cast<std::size_t>(realisations_));
}

std::vector<PlanePoint> BarycentreRefinement::random_places(std::int64_t first, std::int64_t count) const {
  std::vector<PlanePoint> places(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const auto words = random_words(request_.seed, kPlaceStream, half(first + i, 0), half(first + i, 1));
    places[static_cast<std::size_t>(i)] = {low_.x + (high_.x - low_.x) * to_uniform(words[0]),
                                           low_.y + (high_.y - low_.y) * to_uniform(words[1])};
  }
  return places;
}

/// At the barycentre of the triangle around the place, if there is one.
bool BarycentreRefinement::insert_into(const PlanePoint& place) {
  const int t = mesh_.locate(place, near_);
  if (mesh_.is_ghost(t)) return false;
  const auto& [a, b, c] = mesh_.triangle(t).vertex;
  const PlanePoint &pa = mesh_.point(a), &pb = mesh_.point(b), &pc = mesh_.point(c);
  return insert({(pa.x + pb.x + pc.x) / 3.0, (pa.y + pb.y + pc.y) / 3.0}, t, options_.law);
}

/// Places are drawn in batches and taken along a curve within each: neighbours in the plane are then neighbours in
/// memory, without which a million insertions wait for it four times as long.
std::int64_t BarycentreRefinement::refine(std::int64_t count) {
  reserve(count + (options_.insert_cell_centres ? std::int64_t{request_.grid.rows} * request_.grid.columns : 0));
  if (!(low_.x < high_.x && low_.y < high_.y)) return 0;
  std::int64_t done = 0, tried = 0;
  while (done < count && tried < kTriesPerPoint * count + 1000) {
    const std::int64_t batch = std::min<std::int64_t>(count - done, 32 + mesh_.vertex_count() / 4);
    const std::vector<PlanePoint> places = random_places(tried, batch);
    tried += batch;
    for (const int i : curve_order(places)) {
      if (options_.law == BarycentreLaw::published && (done == 0 || mesh_.vertex_count() >= 2 * stage_begin_))
        measure_spread();
      done += insert_into(places[static_cast<std::size_t>(i)]);
    }
    if (request_.on_progress) request_.on_progress(static_cast<double>(done) / static_cast<double>(count));
  }
  return done;
}

void BarycentreRefinement::insert_cell_centres() {
  const BarycentreLaw law =  // equal weights are for barycentres alone
      options_.law == BarycentreLaw::neighbours ? BarycentreLaw::neighbours : BarycentreLaw::conditional;
  std::vector<PlanePoint> centres;
  centres.reserve(static_cast<std::size_t>(request_.grid.rows) * static_cast<std::size_t>(request_.grid.columns));
  for (int r = 0; r < request_.grid.rows; ++r)
    for (int c = 0; c < request_.grid.columns; ++c) centres.push_back({static_cast<double>(c), static_cast<double>(r)});
  for (const int i : insertion_order(centres)) {
    const PlanePoint p = centres[static_cast<std::size_t>(i)];
    const int t = mesh_.locate(p, near_);
    if (!mesh_.is_ghost(t)) insert(p, t, law);
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
