#include "fractal/reconstruction/polyhedron.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/random.hpp"
#include "fractal/reconstruction/realisations.hpp"
#include "fractal/reconstruction/triangulated_samples.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kStream = 0x706f6c7968656472;  // "polyhedr"
constexpr int kMaxIterations = 40;

std::uint64_t scrambled(std::uint64_t key) {  // the finaliser of SplitMix64
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9;
  key = (key ^ (key >> 27)) * 0x94d049bb133111eb;
  return key ^ (key >> 31);
}

/// A vertex and its name: that of a midpoint follows from the names of the ends, so the triangles on either side of an
/// edge find the same midpoint without telling one another.
struct Vertex {
  SurfacePoint at;
  std::uint64_t name = 0;
};

/// One realisation, triangle by triangle, depth first: nothing is stored but the path.
class Refinement {
 public:
  Refinement(const SurfaceRequest& request, const PolyhedronOptions& options, int k, Grid<float>& out)
      : request_(request),
        limit_(options.iterations > 0 ? options.iterations : kMaxIterations),
        shortest_(options.shortest_edge_m > 0.0 ? options.shortest_edge_m / request.grid.cell_m : 1.0),
        stream_(kStream + static_cast<std::uint64_t>(k)),
        out_(out) {
    set_law(request.law.law);
  }
  int iterations() const { return deepest_; }

  void refine(const Vertex& a, const Vertex& b, const Vertex& c, int depth = 0) {
    if (outside(a.at, b.at, c.at)) return;
    const bool ab = splits(a, b, depth), bc = splits(b, c, depth), ca = splits(c, a, depth);
    if (!ab && !bc && !ca) return rasterise_triangle(a.at, b.at, c.at, out_);
    deepest_ = std::max(deepest_, depth + 1);
    if (ab && bc && ca) return quarter(a, b, c, depth + 1);
    if (ab && bc) return third(b, c, a, depth + 1);  // the corner between the broken edges first
    if (bc && ca) return third(c, a, b, depth + 1);
    if (ca && ab) return third(a, b, c, depth + 1);
    if (ab) return halve(a, b, c, depth + 1);
    if (bc) return halve(b, c, a, depth + 1);
    halve(c, a, b, depth + 1);
  }

 private:
  void quarter(const Vertex& a, const Vertex& b, const Vertex& c, int depth) {
    const Vertex ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    refine(a, ab, ca, depth);
    refine(ab, b, bc, depth);
    refine(ca, bc, c, depth);
    refine(ab, bc, ca, depth);
  }
  /// Edges ab and ac break, bc stays.
  void third(const Vertex& a, const Vertex& b, const Vertex& c, int depth) {
    const Vertex ab = midpoint(a, b), ca = midpoint(c, a);
    refine(a, ab, ca, depth);
    refine(ab, b, c, depth);
    refine(ab, c, ca, depth);
  }
  void halve(const Vertex& a, const Vertex& b, const Vertex& c, int depth) {
    const Vertex ab = midpoint(a, b);
    refine(a, ab, c, depth);
    refine(ab, b, c, depth);
  }

  static double length(const Vertex& a, const Vertex& b) { return std::hypot(a.at.x - b.at.x, a.at.y - b.at.y); }
  bool splits(const Vertex& a, const Vertex& b, int depth) const { return depth < limit_ && length(a, b) >= shortest_; }

  bool outside(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c) const {
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [low, high] = std::minmax({a.y, b.y, c.y});
    return right < -0.5 || high < -0.5 || left > out_.columns() - 0.5 || low > out_.rows() - 0.5;
  }

  void set_law(const FractalLaw& law) {
    hurst_ = law.hurst();
    unit_m_ = law.rms_change_m(request_.grid.cell_m) * std::sqrt(1.0 - std::pow(2.0, 2.0 * hurst_ - 2.0));
  }

  Vertex midpoint(const Vertex& a, const Vertex& b) {
    Vertex m;
    m.at = {0.5 * (a.at.x + b.at.x), 0.5 * (a.at.y + b.at.y), 0.5 * (a.at.z_m + b.at.z_m)};
    m.name = scrambled(std::min(a.name, b.name) * 0x9e3779b97f4a7c15 + std::max(a.name, b.name));
    if (request_.law.varies()) set_law(law_at(request_, m.at.x, m.at.y));
    const auto normals = random_normals(request_.seed, stream_, static_cast<std::int32_t>(m.name),
                                        static_cast<std::int32_t>(m.name >> 32));
    m.at.z_m += unit_m_ * std::pow(0.5 * length(a, b), hurst_) * normals[0];
    return m;
  }

  const SurfaceRequest& request_;
  int limit_, deepest_ = 0;
  double shortest_;  // cells
  double hurst_ = 0.5, unit_m_ = 0.0;
  std::uint64_t stream_;
  Grid<float>& out_;
};

}  // namespace

Result<SurfaceEstimate> reconstruct_polyhedron(const HeightSamples& samples, const SurfaceRequest& request,
                                               const PolyhedronOptions& options, Executor& executor) {
  if (options.iterations < 0)
    return Error{ErrorKind::usage,
                 fmt::format("polyhedron: expected 0 or more iterations, found {}", options.iterations)};
  if (!(options.shortest_edge_m >= 0.0 && std::isfinite(options.shortest_edge_m)))
    return Error{ErrorKind::usage,
                 fmt::format("polyhedron: expected a shortest edge of 0 m or more, found {}", options.shortest_edge_m)};
  const auto surface = triangulate(samples, request);
  if (!surface) return surface.error();
  const auto vertex = [&](int v) { return Vertex{surface->at(v), scrambled(static_cast<std::uint64_t>(v) + 1)}; };
  std::vector<int> iterations(static_cast<std::size_t>(realisation_count(request)));
  SurfaceEstimate result = estimate_from_realisations(request, executor, [&](int k, Grid<float>& out) {
    Refinement refinement(request, options, k, out);
    for (int t = 0; t < surface->mesh.triangle_count(); ++t) {
      if (surface->mesh.is_ghost(t)) continue;
      const auto& [a, b, c] = surface->mesh.triangle(t).vertex;
      refinement.refine(vertex(a), vertex(b), vertex(c));
    }
    iterations[static_cast<std::size_t>(k)] = refinement.iterations();
  });
  result.iterations = *std::max_element(iterations.begin(), iterations.end());
  return result;
}

}  // namespace scree::fractal
