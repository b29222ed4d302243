#include "fractal/reconstruction/octave_bands.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr double kReferenceHurst = 0.5;

double frequency(int u, int side) {
  return 2.0 * std::numbers::pi * u / side;
}

/// Spectrum of fBm on the lattice, unit rms change over a cell: S0·Σ_m |k + 2πm|^−(2+2H), beyond the nearest waves as
/// an integral.
double lattice_spectrum(double hurst, double x, double y) {
  constexpr int kNear = 3;
  const double exponent = -1.0 - hurst, turn = 2.0 * std::numbers::pi;
  double sum = 0.0;
  for (int m = -kNear; m <= kNear; ++m)
    for (int n = -kNear; n <= kNear; ++n)
      sum += std::pow((x + turn * m) * (x + turn * m) + (y + turn * n) * (y + turn * n), exponent);
  const double radius = turn * (2 * kNear + 1) / std::sqrt(std::numbers::pi);  // of the disc as large as the square
  sum += turn / (turn * turn) * std::pow(radius, -2.0 * hurst) / (2.0 * hurst);
  return turn * hurst * std::pow(4.0, hurst) * std::tgamma(1.0 + hurst) / std::tgamma(1.0 - hurst) * sum;
}

}  // namespace

double OctaveBands::wavenumber(int band) {
  return 1.3 * std::numbers::pi * std::ldexp(1.0, -band);
}

OctaveBands::OctaveBands(int bands, int side) : bands_(bands), reference_(make_embedding(kReferenceHurst, side)) {}

double OctaveBands::weight(int band, double k) const {
  const double away = k > 0.0 ? std::log2(k / wavenumber(band)) : -1e9;
  if (band == 0 && away > 0.0) return 1.0;
  if (band == bands_ - 1 && away < 0.0) return 1.0;
  return std::max(0.0, 1.0 - std::abs(away));
}

Grid<float> OctaveBands::make(int band, std::uint64_t seed, std::uint64_t stream, int rows, int columns) const {
  const int every = spacing(band), side = reference_.side, coarse = side / every;
  const int half = coarse / 2, n = half + 1, fine_n = side / 2 + 1;
  FbmEmbedding embedding = reference_;
  embedding.side = coarse;
  embedding.eigenvalues.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0.0);
  for (int v = 0; v < n; ++v)
    for (int u = 0; u < n; ++u) {
      const double w = weight(band, std::hypot(frequency(u, side), frequency(v, side)));
      const double lambda = reference_.eigenvalues[static_cast<std::size_t>(v) * static_cast<std::size_t>(fine_n) +
                                                   static_cast<std::size_t>(u)];
      // A wave keeps its amplitude on the coarser torus: 1/side is the transform's own normalisation.
      embedding.eigenvalues[static_cast<std::size_t>(v) * static_cast<std::size_t>(n) + static_cast<std::size_t>(u)] =
          w * w * std::max(lambda, 0.0) / (static_cast<double>(every) * every);
    }
  const WhiteNoiseRow white = [=](int v, std::complex<float>* row) {
    for (int u = 0; u < coarse; ++u) {
      const auto normals = random_normals(seed, stream, u <= half ? u : u + side - coarse, v);
      row[u] = {static_cast<float>(normals[0]), static_cast<float>(normals[1])};
    }
  };
  return embedded_field(embedding, white, rows, columns);
}

const BandGains& BandGains::instance() {
  static const BandGains gains;
  return gains;
}

double BandGains::exact_log_gain(int band, double hurst) {
  constexpr int kSteps = 48;  // along either axis of the first quadrant, to the band's own end
  const double centre = OctaveBands::wavenumber(band);
  const double end = band == 0 ? std::numbers::pi : std::min(std::numbers::pi, centre * std::exp2(0.25));
  double sum = 0.0, count = 0.0;
  for (int v = 0; v < kSteps; ++v)
    for (int u = 0; u < kSteps; ++u) {
      const double x = (u + 0.5) * end / kSteps, y = (v + 0.5) * end / kSteps;
      const double away = std::log2(std::hypot(x, y) / centre);
      if (!(std::abs(away) < 0.25 || (band == 0 && away > 0.0))) continue;
      sum += lattice_spectrum(hurst, x, y) / lattice_spectrum(kReferenceHurst, x, y);
      count += 1.0;
    }
  return 0.5 * std::log(sum / count);
}

BandGains::BandGains() : polynomials_{} {
  constexpr int kNodes = 19;
  for (int band = 0; band < kTabulated; ++band) {
    Eigen::Matrix<double, kNodes, kTerms> powers;
    Eigen::Matrix<double, kNodes, 1> gains;
    for (int node = 0; node < kNodes; ++node) {
      const double hurst = 0.05 * (node + 1);
      gains(node) = exact_log_gain(band, hurst) - 0.5 * std::log(2.0 * (1.0 - hurst));
      for (int i = 0; i < kTerms; ++i) powers(node, i) = std::pow(hurst - 0.5, i);
    }
    const Eigen::Matrix<double, kTerms, 1> p = powers.colPivHouseholderQr().solve(gains);
    for (int i = 0; i < kTerms; ++i)
      polynomials_[static_cast<std::size_t>(band)][static_cast<std::size_t>(i)] = static_cast<float>(p(i));
  }
}

BandGains::Polynomial BandGains::log_gain(int band) const {
  Polynomial p = polynomials_[static_cast<std::size_t>(std::min(band, kTabulated - 1))];
  p[1] += static_cast<float>(std::max(band - (kTabulated - 1), 0)) * std::numbers::ln2_v<float>;
  return p;
}

}  // namespace scree::fractal
