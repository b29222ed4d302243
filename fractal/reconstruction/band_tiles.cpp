#include "fractal/reconstruction/band_tiles.hpp"

#include <algorithm>

#include "fractal/fourier.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kStream = 0x7265732d62616e;  // "res-ban", the noise in the last byte

/// Half of it and a quarter of its coarsest lattice are whole numbers.
int torus_side(int longest_window_cells) {
  const int block = 2 * OctaveBands::spacing(BandTiles::kBands - 1);
  return block * smooth_even_size((2 * std::max(longest_window_cells, 64) + block - 1) / block);
}

}  // namespace

BandTiles::BandTiles(std::uint64_t seed, int longest_window_cells)
    : seed_(seed), bands_(kBands, torus_side(longest_window_cells)) {}

void BandTiles::prepare(int fields) {
  for (int k = 0; k < fields; ++k) {
    const auto part = static_cast<std::size_t>(k % 2 + 2 * (k / 8));
    if (part >= parts_.size()) parts_.resize(part + 1);
    if (!parts_[part].empty()) continue;
    for (int band = 0; band < kBands; ++band) {
      const int points = bands_.side() / OctaveBands::spacing(band);
      parts_[part].push_back(bands_.make(band, seed_, (kStream << 8) + part, points, points));
    }
  }
}

void BandTiles::make_field(const BandAmplitudes& amplitudes, int k, BandAmplitudes::Scratch& scratch,
                           PaddedField& u) const {
  const CellIndex shift{(k / 2 % 2) * (bands_.side() / 2), (k / 4 % 2) * (bands_.side() / 2)};
  const auto& part = parts_[static_cast<std::size_t>(k % 2 + 2 * (k / 8))];
  amplitudes.make_field([&part](int band) -> const Grid<float>& { return part[static_cast<std::size_t>(band)]; }, shift,
                        scratch, u);
}

}  // namespace scree::fractal
