// All points of a triangulation at once: in an order that keeps every walk short.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <numeric>

#include "core/random.hpp"
#include "fractal/reconstruction/delaunay.hpp"

namespace scree::fractal {
namespace {

constexpr int kCurveBits = 20;
constexpr std::uint64_t kRoundStream = 0x64656c61756e6179;  // "delaunay"

/// Place along the Hilbert curve through 2^kCurveBits × 2^kCurveBits cells.
std::uint64_t hilbert_place(std::uint32_t x, std::uint32_t y) {
  std::uint64_t place = 0;
  for (std::uint32_t half = 1U << (kCurveBits - 1); half > 0; half >>= 1) {
    const std::uint32_t right = (x & half) != 0 ? 1 : 0, upper = (y & half) != 0 ? 1 : 0;
    place = 4 * place + ((3 * right) ^ upper);
    if (upper == 0) {  // turn the quadrant into the curve's own position
      if (right == 1) x = ~x, y = ~y;
      std::swap(x, y);
    }
  }
  return place;
}

/// Round of a point: half of all in the last, a quarter in the one before, … ([ACR03]): enough chance that no order of
/// the input makes it slow, enough order that neighbours follow one another.
int round_of(std::int32_t index, int rounds) {
  const std::uint32_t word = random_words(1, kRoundStream, index, 0)[0];
  return std::max(0, rounds - std::countl_zero(word));
}

struct Place {
  std::uint64_t key;
  int index;
};

std::vector<int> insertion_order(const std::vector<PlanePoint>& points) {
  PlanePoint low = points[0], high = points[0];
  for (const PlanePoint& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
  const double scale = ((1U << kCurveBits) - 1) / extent;
  const int rounds = std::max(0, static_cast<int>(std::bit_width(points.size())) - 8);
  std::vector<Place> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = static_cast<std::uint32_t>((points[i].x - low.x) * scale);
    const auto y = static_cast<std::uint32_t>((points[i].y - low.y) * scale);
    const auto round = static_cast<std::uint64_t>(round_of(static_cast<std::int32_t>(i), rounds));
    places[i] = {round << (2 * kCurveBits) | hilbert_place(x, y), static_cast<int>(i)};
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; });
  std::vector<int> order(points.size());
  std::transform(places.begin(), places.end(), order.begin(), [](const Place& p) { return p.index; });
  return order;
}

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
