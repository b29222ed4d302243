#include "fractal/profile_pair.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numbers>

#include "core/random.hpp"
#include "fractal/fourier.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kStream = 0x70726f66696c6573;  // "profiles"
constexpr int kMaxCount = 1 << 24;

/// Covariance of unit increments k apart, of a process with cov(s, t) = ½(|s|^h + |t|^h − |s − t|^h), as the spectrum
/// of its circulant of length `side`: real, as the covariance is even.
std::vector<double> increment_spectrum(double h, int side, Dft<double>& dft) {
  std::vector<std::complex<double>> in(static_cast<std::size_t>(side)), out(in.size());
  for (int k = 0; k < side; ++k) {
    const double lag = std::min(k, side - k);
    in[static_cast<std::size_t>(k)] =
        0.5 * (std::pow(lag + 1.0, h) + std::pow(std::abs(lag - 1.0), h) - 2.0 * std::pow(lag, h));
  }
  dft.forward(in.data(), out.data());
  std::vector<double> spectrum(in.size());
  std::transform(out.begin(), out.end(), spectrum.begin(), [](std::complex<double> s) { return s.real(); });
  return spectrum;
}

struct Spectra {
  std::vector<double> first, second, cross;  // cross for a correlation of 1
};

/// The largest correlation for which every [[S1, ρS12], [ρS12, S2]] is positive.
double embedding_limit(const Spectra& s) {
  double limit = 1.0;
  for (std::size_t k = 0; k < s.first.size(); ++k)
    if (s.cross[k] != 0.0)
      limit = std::min(limit, std::sqrt(std::max(0.0, s.first[k] * s.second[k])) / std::abs(s.cross[k]));
  return limit;
}

Status check(double hurst_1, double hurst_2, int count) {
  const auto usage = [](std::string message) { return Error{ErrorKind::usage, std::move(message)}; };
  for (const double hurst : {hurst_1, hurst_2})
    if (!(hurst > 0.0 && hurst < 1.0))
      return usage(fmt::format("fBm profiles: expected 0 < H < 1, found H = {}", hurst));
  if (count < 2 || count > kMaxCount)
    return usage(fmt::format("fBm profiles: expected 2 to {} values, found {}", kMaxCount, count));
  return {};
}

std::vector<double> summed(const std::vector<std::complex<double>>& increments, int count) {
  std::vector<double> heights(static_cast<std::size_t>(count), 0.0);
  for (std::size_t k = 1; k < heights.size(); ++k) heights[k] = heights[k - 1] + increments[k - 1].real();
  return heights;
}

}  // namespace

double max_profile_correlation(double hurst_1, double hurst_2) {
  const double h = hurst_1 + hurst_2;
  const double own = std::tgamma(2.0 * hurst_1 + 1.0) * std::tgamma(2.0 * hurst_2 + 1.0) *
                     std::sin(std::numbers::pi * hurst_1) * std::sin(std::numbers::pi * hurst_2);
  return hurst_1 == hurst_2 ? 1.0 : std::sqrt(own) / (std::tgamma(h + 1.0) * std::sin(0.5 * std::numbers::pi * h));
}

Result<ProfilePair> fbm_profile_pair(double hurst_1, double hurst_2, double correlation, int count,
                                     std::uint64_t seed) {
  if (Status status = check(hurst_1, hurst_2, count); !status) return status.error();
  const int side = smooth_even_size(2 * count);
  Dft<double> dft(side);
  const Spectra s{increment_spectrum(2.0 * hurst_1, side, dft), increment_spectrum(2.0 * hurst_2, side, dft),
                  increment_spectrum(hurst_1 + hurst_2, side, dft)};
  if (const double limit = hurst_1 == hurst_2 ? 1.0 : embedding_limit(s); !(std::abs(correlation) <= limit))
    return Error{
        ErrorKind::usage,
        fmt::format("fBm profiles: expected a correlation of at most {:.4f} in size for H = {} and {}, found {}", limit,
                    hurst_1, hurst_2, correlation)};
  std::vector<std::complex<double>> one(static_cast<std::size_t>(side)), two(one.size()), out(one.size());
  const double scale = 1.0 / std::sqrt(side);
  for (int k = 0; k < side; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto n1 = random_normals(seed, kStream, k, 0), n2 = random_normals(seed, kStream, k, 1);
    const std::complex<double> first{scale * n1[0], scale * n1[1]}, second{scale * n2[0], scale * n2[1]};
    const double root = std::sqrt(std::max(0.0, s.first[i]));  // rounding may leave −1e-16
    const double common = root > 0.0 ? correlation * s.cross[i] / root : 0.0;
    one[i] = root * first;
    two[i] = common * first + std::sqrt(std::max(0.0, s.second[i] - common * common)) * second;
  }
  ProfilePair pair;
  dft.forward(one.data(), out.data());
  pair.first = summed(out, count);
  dft.forward(two.data(), out.data());
  pair.second = summed(out, count);
  return pair;
}

}  // namespace scree::fractal
