#pragma once
// Orders in which neighbours in the plane follow one another.

#include <span>
#include <vector>

#include "fractal/reconstruction/predicates.hpp"

namespace scree::fractal {

/// Indices of the points along a Hilbert curve over their box: the next is near. Equal places by index.
/// Cost: O(n log n), about .1 µs a point at a million.
std::vector<int> curve_order(std::span<const PlanePoint> points);

/// Along the curve in rounds, half of all points in the last, a quarter in the one before, …: enough chance that no
/// order of the input makes an incremental construction slow, enough order that every walk is short. Deterministic.
/// Source: [ACR03].
std::vector<int> insertion_order(std::span<const PlanePoint> points);

}  // namespace scree::fractal
