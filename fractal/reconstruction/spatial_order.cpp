#include "fractal/reconstruction/spatial_order.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/random.hpp"

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

std::vector<int> sorted_indices(std::span<const PlanePoint> points, int rounds) {
  if (points.empty()) return {};
  PlanePoint low = points[0], high = points[0];
  for (const PlanePoint& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
  const double scale = ((1U << kCurveBits) - 1) / extent;
  std::vector<Place> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = static_cast<std::uint32_t>((points[i].x - low.x) * scale);
    const auto y = static_cast<std::uint32_t>((points[i].y - low.y) * scale);
    const auto round = static_cast<std::uint64_t>(rounds > 0 ? round_of(static_cast<std::int32_t>(i), rounds) : 0);
    places[i] = {round << (2 * kCurveBits) | hilbert_place(x, y), static_cast<int>(i)};
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; });
  std::vector<int> order(points.size());
  std::transform(places.begin(), places.end(), order.begin(), [](const Place& p) { return p.index; });
  return order;
}

}  // namespace

std::vector<int> curve_order(std::span<const PlanePoint> points) {
  return sorted_indices(points, 0);
}

std::vector<int> insertion_order(std::span<const PlanePoint> points) {
  return sorted_indices(points, std::max(0, static_cast<int>(std::bit_width(points.size())) - 8));
}

}  // namespace scree::fractal
