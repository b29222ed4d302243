#pragma once
// The discrete Fourier transform as the rest of the folder sees it. The library behind it is known to fourier.cpp only.

#include <complex>
#include <memory>

namespace scree::fractal {

/// Smallest even size ≥ `at_least` whose prime factors are 2, 3 and 5: the sizes the transform is fast for.
int smooth_even_size(int at_least);

/// Unnormalised forward transform of one length, F_k = Σ_j f_j exp(−2πi jk/n), for T = float or double.
/// Holds the plan; not to be shared between threads. Cost: O(n log n) for smooth n. No allocation after construction.
template <class T>
class Dft {
 public:
  explicit Dft(int length);
  ~Dft();
  Dft(Dft&&) noexcept;
  Dft& operator=(Dft&&) noexcept;

  int length() const { return length_; }
  /// `in` and `out` hold `length()` values and must not overlap.
  void forward(const std::complex<T>* in, std::complex<T>* out);

 private:
  struct Plan;
  int length_;
  std::unique_ptr<Plan> plan_;
};

extern template class Dft<float>;
extern template class Dft<double>;

}  // namespace scree::fractal
