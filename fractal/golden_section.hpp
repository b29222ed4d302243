#pragma once
// Minimum of a function of one variable.

namespace scree::fractal {

/// Where f, of one minimum in [low, high], is least, to 1e-7. Golden-section search; an end of the interval is found as
/// well.
template <class Function>
double golden_minimum(double low, double high, Function f) {
  constexpr double kGolden = 0.6180339887498949, kTolerance = 1e-7;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double fa = f(a), fb = f(b);
  while (high - low > kTolerance) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      fa = f(a = high - kGolden * (high - low));
    } else {
      low = a, a = b, fa = fb;
      fb = f(b = low + kGolden * (high - low));
    }
  }
  return 0.5 * (low + high);
}

}  // namespace scree::fractal
