#pragma once
// Exact sums and products of doubles: an unevaluated sum of parts that do not overlap.

#include <array>
#include <cmath>
#include <cstddef>

namespace scree::fractal {

/// The exact value of a sum, as at most `Capacity` doubles of growing magnitude whose bits do not overlap; the last one
/// has the sign of the whole. Exact as long as nothing under- or overflows: |values| between 1e-60 and 1e60 are safe
/// for the polynomials of predicates.hpp. Source: [S97] grow-expansion, two-sum, two-product.
template <std::size_t Capacity>
class Expansion {
 public:
  Expansion() = default;
  /// a − b
  static Expansion difference(double a, double b) {
    Expansion result;
    result.add(a);
    result.add(-b);
    return result;
  }

  void add(double b) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = b + parts_[i];
      const double b_seen = sum - parts_[i];
      const double rest = (b - b_seen) + (parts_[i] - (sum - b_seen));
      if (rest != 0.0) parts_[kept++] = rest;
      b = sum;
    }
    if (b != 0.0) parts_[kept++] = b;
    size_ = kept;
  }

  template <std::size_t Other>
  void add(const Expansion<Other>& other, double sign = 1.0) {
    for (std::size_t i = 0; i < other.size(); ++i) add(sign * other[i]);
  }

  template <std::size_t Other>
  Expansion<2 * Capacity * Other> operator*(const Expansion<Other>& other) const {
    Expansion<2 * Capacity * Other> result;
    for (std::size_t i = 0; i < size_; ++i)
      for (std::size_t j = 0; j < other.size(); ++j) {
        const double product = parts_[i] * other[j];
        result.add(std::fma(parts_[i], other[j], -product));
        result.add(product);
      }
    return result;
  }

  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0.0 ? 1 : -1; }
  std::size_t size() const { return size_; }
  double operator[](std::size_t i) const { return parts_[i]; }

 private:
  std::array<double, Capacity> parts_;  // only the first size_ hold values: zeroing kilobytes would cost more than use
  std::size_t size_ = 0;
};

template <std::size_t A, std::size_t B>
Expansion<A + B> sum(const Expansion<A>& a, const Expansion<B>& b, double sign_of_b = 1.0) {
  Expansion<A + B> result;
  result.add(a);
  result.add(b, sign_of_b);
  return result;
}

}  // namespace scree::fractal
