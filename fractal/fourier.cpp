#include "fractal/fourier.hpp"

#include <algorithm>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <unsupported/Eigen/FFT>
#pragma GCC diagnostic pop

namespace scree::fractal {

int smooth_even_size(int at_least) {
  for (int size = std::max(2, at_least + at_least % 2);; size += 2) {
    int rest = size;
    for (const int prime : {2, 3, 5})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return size;
  }
}

template <class T>
struct Dft<T>::Plan {
  Eigen::internal::kissfft_impl<T> kissfft;  // the template's own back end, named so that no macro can swap it
};

template <class T>
Dft<T>::Dft(int length) : length_(length), plan_(std::make_unique<Plan>()) {
  std::vector<std::complex<T>> in(static_cast<std::size_t>(length)), out(in.size());
  forward(in.data(), out.data());  // makes the plan now, so that later calls do not allocate
}
template <class T>
Dft<T>::~Dft() = default;
template <class T>
Dft<T>::Dft(Dft&&) noexcept = default;
template <class T>
Dft<T>& Dft<T>::operator=(Dft&&) noexcept = default;

template <class T>
void Dft<T>::forward(const std::complex<T>* in, std::complex<T>* out) {
  plan_->kissfft.fwd(out, in, length_);
}

template class Dft<float>;
template class Dft<double>;

}  // namespace scree::fractal
