#pragma once
// Convolutions of maps with kernels that are even both ways and alike in both.

#include <algorithm>
#include <complex>
#include <vector>

#include "fractal/fourier.hpp"

namespace scree::bench {

/// Two real n × n fields as one complex one, padded with zeros to a torus of at least twice the side, and back.
class PaddedTransform {
 public:
  using Complex = std::complex<double>;
  using Plane = std::vector<Complex>;
  explicit PaddedTransform(int n)
      : n_(n), side_(fractal::smooth_even_size(2 * n)), dft_(side_), line_(at(side_)), half_(at(side_) * at(side_)) {}
  int side() const { return side_; }

  /// The spectrum comes transposed: the kernels are symmetric.
  void forward(const Plane& field, Plane& spectrum) {
    std::fill(half_.begin(), half_.end(), Complex());
    Plane out(at(side_));
    for (int r = 0; r < n_; ++r) {
      std::fill(line_.begin(), line_.end(), Complex());
      std::copy_n(field.begin() + r * n_, n_, line_.begin());
      dft_.forward(line_.data(), out.data());
      for (int u = 0; u < side_; ++u) half_[at(u * side_ + r)] = out[at(u)];
    }
    for (int u = 0; u < side_; ++u) dft_.forward(&half_[at(u * side_)], &spectrum[at(u * side_)]);
  }
  /// The inverse, by conjugation before and after.
  void backward(Plane& spectrum, Plane& field) {
    Plane out(at(side_));
    for (Complex& v : spectrum) v = std::conj(v);
    for (int u = 0; u < side_; ++u) {
      dft_.forward(&spectrum[at(u * side_)], out.data());
      for (int r = 0; r < n_; ++r) half_[at(r * side_ + u)] = out[at(r)];
    }
    for (int r = 0; r < n_; ++r) {
      dft_.forward(&half_[at(r * side_)], out.data());
      for (int c = 0; c < n_; ++c) field[at(r * n_ + c)] = std::conj(out[at(c)]) / (1.0 * side_ * side_);
    }
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int n_, side_;
  fractal::Dft<double> dft_;
  Plane line_, half_;
};

}  // namespace scree::bench
