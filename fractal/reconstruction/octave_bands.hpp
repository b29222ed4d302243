#pragma once
// fBm as a sum of octave bands of one white noise, so that D and amplitude may differ from cell to cell.

#include <array>
#include <cstdint>
#include <vector>

#include "fractal/fbm_embedding.hpp"

namespace scree::fractal {

/// u(x) = Σ_l A_l(x)·B_l(x). Band l holds the waves around k_l = 1.3π·2^−l rad a cell: hats in log2 k that add up to 1,
/// times the root of the spectrum at H = ½. The bands share their noise, so neighbours add as amplitudes and the sum
/// interpolates between octaves. Band 0 is all above k_0, the last all below its k. Bands 0 … 3 need every cell; band l
/// beyond is three times oversampled at every 2^(l−3)-th.
class OctaveBands {
 public:
  static constexpr int kFirstCoarse = 4;  ///< the first band that is stored coarsely
  static double wavenumber(int band);
  static int spacing(int band) { return band < kFirstCoarse ? 1 : 1 << (band - kFirstCoarse + 1); }

  /// `side` cells, a multiple of spacing(bands − 1) and even after division by it. Cost: one transform of side/2.
  OctaveBands(int bands, int side);

  int bands() const { return bands_; }
  int side() const { return reference_.side; }
  int coarsest() const { return spacing(bands_ - 1); }
  /// Share of band l in the amplitude at wavenumber k; they add up to 1.
  double weight(int band, double k) const;

  /// Band l on rows × columns points spacing(l) cells apart, from the torus' point (0, 0): float32, unit variogram at
  /// H = ½ when all bands are added. Noise keyed on (seed, stream, frequency), the same for every band.
  Grid<float> make(int band, std::uint64_t seed, std::uint64_t stream, int rows, int columns) const;

 private:
  int bands_;
  FbmEmbedding reference_;
};

/// Log of the amplitude of band l for an fBm of exponent H with unit rms change over a cell: rms over the band's core
/// of the ratio of the lattice spectra (which holds the aliases that matter in bands 0 and 1). But for a factor that
/// vanishes as 1 − H it is nearly straight in H: a polynomial of fifth degree holds it to one percent above H = 0.1 and
/// to two below (octave_bands_test.cpp). From band 5 on, where power laws have become exact, (H − ½)·log 2 more each.
class BandGains {
 public:
  /// Made once, some tens of ms.
  static const BandGains& instance();
  /// log gain(H) = ½ log(2·(1 − H)) + Σ_i p_i·(H − ½)^i, 0.05 ≤ H ≤ 0.95.
  static constexpr int kTerms = 6;
  using Polynomial = std::array<float, kTerms>;
  Polynomial log_gain(int band) const;
  /// What the polynomial stands for.
  static double exact_log_gain(int band, double hurst);

 private:
  BandGains();
  static constexpr int kTabulated = 5;
  std::array<Polynomial, kTabulated> polynomials_;
};

}  // namespace scree::fractal
