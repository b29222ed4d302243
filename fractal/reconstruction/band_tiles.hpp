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
  /// Row `start.y` of field k from `start.x` on, in the unit of the amplitudes. Const and safe from many threads.
  void surface_row(const BandAmplitudes& amplitudes, int k, CellIndex start, int count, std::vector<float>& line,
                   float* out) const;

 private:
  std::uint64_t seed_;
  OctaveBands bands_;
  std::vector<std::vector<Grid<float>>> parts_;
};

}  // namespace scree::fractal
