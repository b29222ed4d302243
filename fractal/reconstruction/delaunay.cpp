#include "fractal/reconstruction/delaunay.hpp"

namespace scree::fractal {
namespace {

constexpr std::array<int, 5> kNext = {0, 1, 2, 0, 1};  // index k + 1 or k + 2 of a triangle, wrapped

int at(const std::array<int, 3>& three, int k) {
  return three[static_cast<std::size_t>(kNext[static_cast<std::size_t>(k)])];
}

/// p on the line through u and v: strictly between them?
bool between(const PlanePoint& u, const PlanePoint& v, const PlanePoint& p) {
  return u.x != v.x ? (u.x < p.x) == (p.x < v.x) && p.x != u.x && p.x != v.x
                    : (u.y < p.y) == (p.y < v.y) && p.y != u.y && p.y != v.y;
}

int infinite_slot(const Delaunay::Triangle& triangle) {
  for (int k = 0; k < 3; ++k)
    if (at(triangle.vertex, k) == Delaunay::kInfinite) return k;
  return -1;
}

}  // namespace

void Delaunay::reserve(std::size_t vertices) {
  points_.reserve(vertices);
  triangles_.reserve(2 * vertices + 2);
}

bool Delaunay::is_ghost(int index) const {
  return infinite_slot(triangle(index)) >= 0;
}

/// The first triangle and its three ghosts; a, b, c counter-clockwise.
void Delaunay::start(int a, int b, int c) {
  triangles_ = {{{a, b, c}, {1, 2, 3}},
                {{kInfinite, c, b}, {0, 3, 2}},
                {{kInfinite, a, c}, {0, 1, 3}},
                {{kInfinite, b, a}, {0, 2, 1}}};
  star_ = {0};
}

/// Open disc of the circumcircle; of a ghost the open half-plane beyond its edge, with the edge's inside.
bool Delaunay::in_conflict(const Triangle& triangle, const PlanePoint& p) const {
  const int ghost = infinite_slot(triangle);
  if (ghost < 0)
    return in_circle(point(triangle.vertex[0]), point(triangle.vertex[1]), point(triangle.vertex[2]), p) > 0;
  const PlanePoint& u = point(at(triangle.vertex, ghost + 1));
  const PlanePoint& v = point(at(triangle.vertex, ghost + 2));
  const int side = orientation(u, v, p);
  return side > 0 || (side == 0 && between(u, v, p));
}

/// Slot k of the triangle whose edge, opposite vertex[k], begins at `vertex`.
int Delaunay::edge_from(int index, int vertex) const {
  const Triangle& t = triangle(index);
  for (int k = 0; k < 2; ++k)
    if (at(t.vertex, k + 1) == vertex) return k;
  return 2;
}

int Delaunay::locate(const PlanePoint& p, int near) const {
  int now = near, before = -1;
  if (const int ghost = infinite_slot(triangle(near)); ghost >= 0) now = at(triangle(near).neighbour, ghost);
  for (;;) {  // the visibility walk ends in any Delaunay triangulation
    const Triangle& t = triangle(now);
    if (infinite_slot(t) >= 0) return now;
    int next = -1;
    for (int k = 0; k < 3 && next < 0; ++k)
      if (at(t.neighbour, k) != before && orientation(point(at(t.vertex, k + 1)), point(at(t.vertex, k + 2)), p) < 0)
        next = at(t.neighbour, k);
    if (next < 0) return now;
    before = now;
    now = next;
  }
}

/// The triangles in conflict with p are connected and hold no vertex inside: their dual graph is a tree, and going
/// through it edge by edge gives the border in order.
void Delaunay::dig(int first, const PlanePoint& p) {
  removed_.assign(1, first);
  border_.clear();
  stack_.assign({{first, 2}, {first, 1}, {first, 0}});
  while (!stack_.empty()) {
    const auto [index, k] = stack_.back();
    stack_.pop_back();
    const Triangle& t = triangle(index);
    const int outer = at(t.neighbour, k), from = at(t.vertex, k + 1), to = at(t.vertex, k + 2);
    const int back = edge_from(outer, to);
    if (in_conflict(triangle(outer), p)) {
      removed_.push_back(outer);
      stack_.push_back({outer, kNext[static_cast<std::size_t>(back) + 2]});
      stack_.push_back({outer, kNext[static_cast<std::size_t>(back) + 1]});
    } else {
      border_.push_back({from, to, outer, back});
    }
  }
}

void Delaunay::fill(int vertex) {
  const std::size_t count = border_.size();
  star_.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    star_[i] = i < removed_.size() ? removed_[i] : triangle_count() + static_cast<int>(i - removed_.size());
  triangles_.resize(triangles_.size() + (count - removed_.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [from, to, outer, slot] = border_[i];
    const int next = star_[i + 1 < count ? i + 1 : 0], previous = star_[i > 0 ? i - 1 : count - 1];
    triangles_[static_cast<std::size_t>(star_[i])] = {{from, to, vertex}, {next, previous, outer}};
    triangles_[static_cast<std::size_t>(outer)].neighbour[static_cast<std::size_t>(slot)] = star_[i];
  }
}

/// The vertex of the triangle at exactly this place, or kInfinite.
int Delaunay::vertex_at(int index, const PlanePoint& p) const {
  for (const int vertex : triangle(index).vertex)
    if (vertex != kInfinite && point(vertex) == p) return vertex;
  return kInfinite;
}

/// Joins a point that is stored already; false when a vertex is there.
bool Delaunay::connect(int vertex, int near) {
  const PlanePoint p = point(vertex);
  const int home = locate(p, near);
  if (vertex_at(home, p) != kInfinite) return false;
  dig(home, p);
  fill(vertex);
  return true;
}

Delaunay::Insertion Delaunay::insert(const PlanePoint& p, int near) {
  const int home = locate(p, near);
  if (const int there = vertex_at(home, p); there != kInfinite) return {there, false};
  const int vertex = vertex_count();
  points_.push_back(p);
  dig(home, p);
  fill(vertex);
  return {vertex, true};
}

}  // namespace scree::fractal
