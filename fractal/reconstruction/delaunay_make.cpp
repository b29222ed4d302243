// All points of a triangulation at once: in an order that keeps every walk short.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "fractal/reconstruction/delaunay.hpp"
#include "fractal/reconstruction/spatial_order.hpp"

namespace scree::fractal {
namespace {

Error bad(std::string message) {
  return {ErrorKind::bad_data, std::move(message)};
}

}  // namespace

Result<Delaunay> Delaunay::make(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size())
    return bad(fmt::format("triangulation: expected as many x as y, found {} and {}", x.size(), y.size()));
  if (x.size() < 3) return bad(fmt::format("triangulation: expected at least 3 points, found {}", x.size()));
  Delaunay result;
  result.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
      return bad(fmt::format("triangulation: expected finite coordinates, found ({}, {}) at point {}", x[i], y[i], i));
    result.points_.push_back({x[i], y[i]});
  }
  result.representative_.resize(x.size());
  std::iota(result.representative_.begin(), result.representative_.end(), 0);
  const std::vector<int> order = insertion_order(result.points_);
  const auto& points = result.points_;
  const auto place = [&points](int i) { return points[static_cast<std::size_t>(i)]; };
  const int a = order[0];
  const auto b = std::find_if(order.begin(), order.end(), [&](int i) { return place(i) != place(a); });
  const auto c = std::find_if(b, order.end(), [&](int i) { return orientation(place(a), place(*b), place(i)) != 0; });
  if (c == order.end())
    return bad(fmt::format("triangulation: expected points off one line, found {} on one", x.size()));
  const bool left = orientation(place(a), place(*b), place(*c)) > 0;
  result.start(a, left ? *b : *c, left ? *c : *b);
  for (const int i : order) {
    if (i == a || i == *b || i == *c) continue;
    if (result.connect(i, result.star_[0])) continue;
    const int there = result.vertex_at(result.locate(place(i), result.star_[0]), place(i));
    result.representative_[static_cast<std::size_t>(i)] = there;
    ++result.repeated_;
  }
  return result;
}

}  // namespace scree::fractal
