#include "fractal/increment_covariance.hpp"

#include <algorithm>
#include <cstdlib>

namespace scree::fractal {
IncrementKernel::IncrementKernel(Support support, double hurst, int reach)
    : side_(reach + 1), values_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {
  for (int dy = 0; dy < side_; ++dy)
    for (int dx = 0; dx <= dy; ++dx)
      values_[index(dx, dy)] = values_[index(dy, dx)] = -0.5 * mean_variogram(support, hurst, dx, dy);
}

double IncrementKernel::operator()(int dx, int dy) const {
  return values_[index(std::abs(dx), std::abs(dy))];
}

IncrementPair::IncrementPair(const Increment& p, const Increment& q) {
  for (const auto& a : p)
    for (const auto& b : q) {
      const int dx = a.dx - b.dx, dy = a.dy - b.dy;
      auto term = std::find_if(terms_.begin(), terms_.end(), [&](const Term& t) { return t.dx == dx && t.dy == dy; });
      if (term == terms_.end()) term = terms_.insert(term, {dx, dy, 0, 0});
      term->weight += a.weight * b.weight;
      ++term->pairs;
    }
}

IncrementCovariance IncrementPair::covariance(const IncrementKernel& kernel, int ox, int oy) const {
  IncrementCovariance sum;
  for (const Term& t : terms_) {
    sum.signal += t.weight * kernel(t.dx - ox, t.dy - oy);
    if (t.dx == ox && t.dy == oy) sum.noise += t.weight;
  }
  return sum;
}

int IncrementPair::shared_cells(int ox, int oy) const {
  int shared = 0;
  for (const Term& t : terms_)
    if (t.dx == ox && t.dy == oy) shared += t.pairs;
  return shared;
}

}  // namespace scree::fractal
