#pragma once
// World-anchored octave bands for a window that moves over ground whose law varies.

#include <cstdint>
#include <vector>

#include "fractal/reconstruction/band_amplitudes.hpp"

namespace scree::fractal {

/// Bands of K fields on a torus that never changes: what moves with D and amplitude are the amplitudes only. Two noises
/// serve eight fields, from four corners half the side apart. Memory: 4.3 floats a cell of the torus and noise.
class BandTiles {
 public:
  /// Seven bands on a torus of at least twice `longest_window_cells`.
  BandTiles(std::uint64_t seed, int longest_window_cells);

  static constexpr int kBands = 7;
  /// Makes what the first `fields` fields need, once: some 100 ms a noise at side 512.
  void prepare(int fields);
  /// Field k over the amplitudes' window, in their unit; const and safe from many threads.
  void make_field(const BandAmplitudes& amplitudes, int k, BandAmplitudes::Scratch& scratch, PaddedField& u) const;

 private:
  std::uint64_t seed_;
  OctaveBands bands_;
  std::vector<std::vector<Grid<float>>> parts_;
};

}  // namespace scree::fractal
