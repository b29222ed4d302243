#include "fractal/reconstruction/octave_bands.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr double kReferenceHurst = 0.5;
constexpr int kTableSide = 256;

double frequency(int u, int side) {
  return 2.0 * std::numbers::pi * u / side;
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

BandGains::BandGains() : log_gain_{} {
  const int n = kTableSide / 2 + 1;
  const FbmEmbedding reference = make_embedding(kReferenceHurst, kTableSide);
  for (int node = 0; node < kNodes; ++node) {
    const double hurst = static_cast<double>(kFirst) + static_cast<double>(kStep) * node;
    const FbmEmbedding other = make_embedding(hurst, kTableSide);
    const double scale =
        std::pow(other.unit_cells, 2.0 * hurst) / std::pow(reference.unit_cells, 2.0 * kReferenceHurst);
    for (int band = 0; band < kTabulated; ++band) {
      double sum = 0.0, count = 0.0;
      for (int v = 0; v < n; ++v)
        for (int u = 0; u < n; ++u) {
          const double k = std::hypot(frequency(u, kTableSide), frequency(v, kTableSide));
          const double away = k > 0.0 ? std::log2(k / OctaveBands::wavenumber(band)) : -1e9;
          if (!(std::abs(away) < 0.25 || (band == 0 && away > 0.0))) continue;
          const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(n) + static_cast<std::size_t>(u);
          // Frequencies within the quarter stand for four, those on its border for two.
          const double times = (u % (n - 1) == 0 ? 1.0 : 2.0) * (v % (n - 1) == 0 ? 1.0 : 2.0);
          sum += times * scale * std::max(other.eigenvalues[i], 0.0) / reference.eigenvalues[i];
          count += times;
        }
      log_gain_[static_cast<std::size_t>(band)][static_cast<std::size_t>(node)] =
          static_cast<float>(0.5 * std::log(sum / count));
    }
  }
}

float BandGains::log_gain(int band, float hurst) const {
  const float position = std::clamp((hurst - kFirst) / kStep, 0.0F, static_cast<float>(kNodes - 1));
  const auto node = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kNodes - 2));
  const float t = position - static_cast<float>(node);
  const auto& row = log_gain_[static_cast<std::size_t>(std::min(band, kTabulated - 1))];
  const float beyond = static_cast<float>(std::max(band - (kTabulated - 1), 0)) * std::numbers::ln2_v<float>;
  const float clamped = kFirst + kStep * position;
  return row[node] + t * (row[node + 1] - row[node]) + (clamped - 0.5F) * beyond;
}

}  // namespace scree::fractal
