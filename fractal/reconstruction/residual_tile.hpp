#pragma once
// World-anchored random fields for conditioning: a torus of fBm and a torus of white noise that never change.

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "core/grid.hpp"

namespace scree::fractal {

/// Unconditional surfaces for any D from one white noise, so that a draw changes with D only as much as D implies.
/// Tiles exist at D = 2.05, 2.15, … 2.95 (made when first needed: some tens of ms each at side 768) and are
/// interpolated: the noise is common, so amplitudes add and a blend in between errs by less than 1 % up to lags of 10
/// cells. The law is exact up to side/2 cells (D ≥ 2.25) or side/4; fields repeat every `side` cells of the world.
class ResidualTiles {
 public:
  ResidualTiles(std::uint64_t seed, int side);

  int side() const { return side_; }

  /// Rows of field k, an fBm with unit rms change over one cell; values up to a constant. Fields 2j and 2j + 1 are
  /// independent; those of one parity up to 8 apart are one torus seen from half its side away: independent where data
  /// pin what is that long. `centre` anchors the random plane: any choice shifts the field by a constant only. Call
  /// prepare(dimension, k + 1) first; then const, and safe from many threads.
  void prepare(double dimension, int fields = 1);
  void surface_row(double dimension, int k, CellIndex start, CellIndex centre, int count, float* out) const;

  /// Standard normals of the cells' measurement noise in field k; prepare_noise(k + 1) is enough for them.
  void prepare_noise(int fields);
  void noise_row(int k, CellIndex start, int count, float* out) const;

 private:
  struct Tile {
    Grid<float> field;
    double slope_sigma = 0.0;
  };
  struct Blend {
    std::size_t node;
    float weight;
  };
  static constexpr int kTiles = 10;
  static constexpr double kFirst = 2.05, kStep = 0.1;
  struct Part {
    std::vector<std::complex<float>> white;  // spectrum rows 0 … side/2, filled with the first tile
    std::array<Tile, kTiles> tiles;
    Grid<float> noise;
  };
  static Blend blend_of(double dimension);
  void make_tile(std::size_t part, std::size_t node);
  void make_noise(std::size_t part);
  /// The torus that holds field k, and where.
  static std::size_t part_of(int k) { return static_cast<std::size_t>(k % 2 + 2 * (k / 8)); }
  CellIndex shifted(int k, CellIndex cell) const {
    return {cell.x + (k / 2 % 2) * (side_ / 2), cell.y + (k / 4 % 2) * (side_ / 2)};
  }
  int wrapped(std::int32_t coordinate) const { return ((coordinate % side_) + side_) % side_; }

  std::uint64_t seed_;
  int side_;
  std::vector<Part> parts_;
};

}  // namespace scree::fractal
