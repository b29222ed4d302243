#include "fractal/reconstruction/residual_fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"
#include "fractal/fbm_embedding.hpp"
#include "fractal/fourier.hpp"
#include "fractal/reconstruction/band_amplitudes.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kSpectrumStream = 0x636f6e642d6600;  // "cond-f"
constexpr std::uint64_t kPlaneStream = 0x636f6e642d7000;     // "cond-p"

class OneLawFields final : public ResidualFields {
 public:
  OneLawFields(double hurst, int side, const SurfaceGrid& grid, std::uint64_t seed)
      : embedding_(make_embedding(hurst, side)), grid_(grid), seed_(seed) {}

  void make(int k, PaddedField& u) const override {
    const Grid<float> field =
        embedded_field(embedding_, keyed_white_noise(seed_, field_stream(kSpectrumStream, k), embedding_.side),
                       grid_.rows, grid_.columns);
    const auto normals = random_normals(seed_, field_stream(kPlaneStream, k), 0, 0);
    const double sigma = embedding_.plane_slope_sigma();
    const auto along = static_cast<float>(sigma * normals[0]);
    for (int r = 0; r < grid_.rows; ++r) {
      const auto level =
          static_cast<float>(sigma * (normals[1] * (r - grid_.rows / 2) - normals[0] * (grid_.columns / 2)));
      float* out = u.row(r);
      for (int c = 0; c < grid_.columns; ++c) out[c] = field(r, c) + (level + along * static_cast<float>(c));
    }
  }

 private:
  FbmEmbedding embedding_;
  SurfaceGrid grid_;
  std::uint64_t seed_;
};

class VaryingFields final : public ResidualFields {
 public:
  VaryingFields(const LawMap& law, int bands, int side, const SurfaceGrid& grid, std::uint64_t seed)
      : bands_(bands, side), grid_(grid), seed_(seed) {
    amplitudes_.set(law, {{0, 0}, grid.rows, grid.columns}, law.law.rms_change_m(grid.cell_m), grid.cell_m, bands);
  }

  void make(int k, PaddedField& u) const override {
    BandAmplitudes::Scratch scratch;
    Grid<float> band_field;
    const auto make_band = [&](int band) -> const Grid<float>& {
      const int every = OctaveBands::spacing(band), most = bands_.side() / every;
      const auto points = [&](int cells) { return std::min((cells + bands_.coarsest()) / every + 1, most); };
      band_field = {};
      band_field =
          bands_.make(band, seed_, field_stream(kSpectrumStream, k), points(grid_.rows), points(grid_.columns));
      return band_field;
    };
    amplitudes_.make_field(make_band, {0, 0}, scratch, u);
  }

 private:
  OctaveBands bands_;
  BandAmplitudes amplitudes_;
  SurfaceGrid grid_;
  std::uint64_t seed_;
};

/// Bands whose longest is at least four gaps long, seven at least.
int bands_for(int gap_cells) {
  int bands = 7;
  while (bands < 12 && 2.0 * std::numbers::pi / OctaveBands::wavenumber(bands - 1) < 4.0 * gap_cells) ++bands;
  return bands;
}

}  // namespace

int residual_torus_side(double hurst, int rows, int columns, int gap_cells) {
  const int longer = std::max(rows, columns);
  const int exact = std::max(embedding_side(hurst, std::hypot(rows, columns)), smooth_even_size(longer));
  if (exact <= kExactSide) return exact;
  const int enough = smooth_even_size(std::max({longer + longer / 8, longer + 4 * gap_cells, 16 * gap_cells}));
  return std::min(exact, std::max(enough, smooth_even_size(kExactSide)));
}

std::unique_ptr<ResidualFields> one_law_fields(double hurst, int side, const SurfaceGrid& grid, std::uint64_t seed) {
  return std::make_unique<OneLawFields>(hurst, side, grid, seed);
}

std::unique_ptr<ResidualFields> varying_fields(const LawMap& law, int side, int gap_cells, const SurfaceGrid& grid,
                                               std::uint64_t seed) {
  const int bands = bands_for(gap_cells), coarsest = OctaveBands::spacing(bands - 1);
  const int least = std::max(side, std::max(grid.rows, grid.columns) + 2 * coarsest);
  return std::make_unique<VaryingFields>(law, bands, smooth_even_size((least + coarsest - 1) / coarsest) * coarsest,
                                         grid, seed);
}

}  // namespace scree::fractal
