#include "fractal/reconstruction/octave_bands.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "fractal/reconstruction/band_tiles.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::fractal {
namespace {

TEST(OctaveBands, AddUpToTheWholeSpectrum) {
  const OctaveBands bands(7, 128);
  for (double k = 0.001; k < 4.5; k *= 1.07) {
    double sum = 0.0;
    for (int band = 0; band < 7; ++band) sum += bands.weight(band, k);
    EXPECT_NEAR(sum, 1.0, 1e-12) << k;
  }
}

// A coarse band is the full one at every second, fourth … cell: the same waves from the same noise.
TEST(OctaveBands, CoarseTorusHoldsTheSameWaves) {
  const int side = 128, band = 4, every = OctaveBands::spacing(band);
  const OctaveBands seven(7, side);
  const Grid<float> coarse = seven.make(band, 3, 5, side / every, side / every);
  // The same band by its definition: a sum over the frequencies it holds.
  const FbmEmbedding reference = make_embedding(0.5, side);
  const WhiteNoiseRow white = keyed_white_noise(3, 5, side);
  std::vector<std::vector<std::complex<float>>> noise(static_cast<std::size_t>(side) / 2 + 1);
  for (std::size_t v = 0; v < noise.size(); ++v) {
    noise[v].resize(side);
    white(static_cast<int>(v), noise[v].data());
  }
  FbmEmbedding filtered = reference;
  const int n = side / 2 + 1;
  for (int v = 0; v < n; ++v)
    for (int u = 0; u < n; ++u)
      filtered.eigenvalues[static_cast<std::size_t>(v * n + u)] *=
          std::pow(seven.weight(band, 2.0 * M_PI * std::hypot(u, v) / side), 2);
  const Grid<float> full = embedded_field(filtered, white, side, side);
  for (int r = 0; r < side / every; ++r)
    for (int c = 0; c < side / every; ++c) EXPECT_NEAR(coarse(r, c), full(r * every, c * every), 2e-4F);
}

TEST(OctaveBands, GainsAreTheirPolynomials) {
  for (int band = 0; band < 5; ++band)
    for (const double hurst : {0.07, 0.2, 0.41, 0.5, 0.66, 0.78, 0.93}) {
      const auto p = BandGains::instance().log_gain(band);
      const double h = hurst - 0.5;
      double fitted = 0.0;
      for (std::size_t i = p.size(); i-- > 0;) fitted = fitted * h + static_cast<double>(p[i]);
      fitted += 0.5 * std::log(1.0 - 2.0 * h);
      EXPECT_NEAR(fitted, BandGains::exact_log_gain(band, hurst), hurst < 0.1 ? 0.02 : 0.008) << band << ' ' << hurst;
    }
}

/// A law map of one D everywhere.
LawMap flat_law(double dimension, int rows, int columns) {
  LawMap law{{dimension, 1.0}, {}, {}};
  law.dimension = Grid<float>(rows, columns, static_cast<float>(dimension));
  law.amplitude_m = Grid<float>(rows, columns, 1.0F);
  return law;
}

/// rms second difference of lag r along the axes.
double rms_bend(const Grid<float>& z, int lag) {
  double sum = 0.0, n = 0.0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      const auto add = [&](double a, double b) {
        sum += std::pow(a + b - 2.0 * static_cast<double>(z(r, c)), 2);
        n += 1.0;
      };
      if (c >= lag && c + lag < z.columns()) add(z(r, c - lag), z(r, c + lag));
      if (r >= lag && r + lag < z.rows()) add(z(r - lag, c), z(r + lag, c));
    }
  return std::sqrt(sum / n);
}

Grid<float> field_of(const BandTiles& tiles, const BandAmplitudes& amplitudes, int k, int side) {
  PaddedField u;
  BandAmplitudes::Scratch scratch;
  u.resize(side, side);
  tiles.make_field(amplitudes, k, scratch, u);
  Grid<float> out(side, side);
  for (int r = 0; r < side; ++r) std::copy_n(u.row(r), side, out.row(r).data());
  return out;
}

/// Eight fields of one D.
std::vector<Grid<float>> eight_fields(BandTiles& tiles, double dimension) {
  constexpr int kSide = 256;
  tiles.prepare(8);
  BandAmplitudes amplitudes;
  amplitudes.set(flat_law(dimension, kSide, kSide), {{0, 0}, kSide, kSide}, 1.0, 1.0, BandTiles::kBands);
  std::vector<Grid<float>> fields;
  for (int k = 0; k < 8; ++k) fields.push_back(field_of(tiles, amplitudes, k, kSide));
  return fields;
}

// Second differences: heights and planes are left to the data. 8 fields of 256²: the sampling error is 1 % at lag 16 (8
// · 256 patches, two directions); the gains are means over an octave, which costs up to 3 % at the ends of D.
TEST(OctaveBands, IncrementsGrowAsThePower) {
  BandTiles tiles(7, 256);
  for (const double dimension : {2.1, 2.3, 2.5, 2.7, 2.85}) {
    const auto fields = eight_fields(tiles, dimension);
    for (const int lag : {1, 2, 4, 16}) {
      double square = 0.0;
      for (const Grid<float>& u : fields) square += std::pow(rms_bend(u, lag), 2) / 8.0;
      const FractalLaw law{dimension, 1.0};
      EXPECT_NEAR(std::sqrt(square) / law.rms_bend_m(lag), 1.0, 0.05) << dimension << ' ' << lag;
      std::printf("%.2f %d %.4f\n", dimension, lag, std::sqrt(square) / law.rms_bend_m(lag));
    }
  }
}

// Zones of the law keep their own roughness up to their borders: the long waves of rough ground do not leak. Amplitude
// .1 and 1 over the same D, margin 24 cells, 4 fields of 128 × 256.
TEST(OctaveBands, SmoothGroundStaysSmoothBesideRoughGround) {
  constexpr int kSide = 256;
  LawMap law = flat_law(2.5, kSide, kSide);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide / 2; ++c) law.amplitude_m(r, c) = 0.1F;
  BandTiles tiles(7, kSide);
  tiles.prepare(1);
  BandAmplitudes amplitudes;
  amplitudes.set(law, {{0, 0}, kSide, kSide}, 1.0, 1.0, BandTiles::kBands);
  const Grid<float> u = field_of(tiles, amplitudes, 0, kSide);
  for (const auto& [first, expected] : {std::pair{0, 0.1}, {kSide / 2 + 24, 1.0}}) {
    Grid<float> zone(kSide, kSide / 2 - 24);
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < zone.columns(); ++c) zone(r, c) = u(r, first + c);
    const FractalLaw own{2.5, expected};
    for (const int lag : {1, 4, 8}) EXPECT_NEAR(rms_bend(zone, lag) / own.rms_bend_m(lag), 1.0, 0.1) << expected;
  }
}

// The noise belongs to the ground: a window elsewhere sees the same field, as long as the law is the same.
TEST(OctaveBands, AMovedWindowSeesTheSameField) {
  const LawMap law = flat_law(2.4, 64, 64);
  BandTiles tiles(7, 64);
  tiles.prepare(4);
  BandAmplitudes here, there;
  here.set(law, {{-100, 7}, 64, 64}, 1.0, 1.0, BandTiles::kBands);
  there.set(law, {{-87, 12}, 64, 64}, 1.0, 1.0, BandTiles::kBands);
  for (int k = 0; k < 4; ++k) {
    const Grid<float> a = field_of(tiles, here, k, 64), b = field_of(tiles, there, k, 64);
    for (int r = 5; r < 64; ++r)
      for (int c = 13; c < 64; ++c) ASSERT_NEAR(a(r, c), b(r - 5, c - 13), 1e-4F);
  }
}

}  // namespace
}  // namespace scree::fractal
