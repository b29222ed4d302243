#include "fractal/reconstruction/residual_tile.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/fbm_embedding.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kSpectrumStream = 0x7265732d73706563;  // "res-spec"
constexpr std::uint64_t kPlaneStream = 0x7265732d706c616e;     // "res-plan"
constexpr std::uint64_t kNoiseStream = 0x7265732d6e6f6973;     // "res-nois"

}  // namespace

ResidualTiles::ResidualTiles(std::uint64_t seed, int side) : seed_(seed), side_(side), noise_(side, side) {
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; x += 2) {
      const auto normals = random_normals(seed, kNoiseStream, x, y);
      noise_(y, x) = static_cast<float>(normals[0]);
      if (x + 1 < side) noise_(y, x + 1) = static_cast<float>(normals[1]);
    }
}

ResidualTiles::Blend ResidualTiles::blend_of(double dimension) {
  const double position = std::clamp((dimension - kFirst) / kStep, 0.0, static_cast<double>(kTiles - 1));
  const auto node = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kTiles - 2));
  return {node, static_cast<float>(position - static_cast<double>(node))};
}

void ResidualTiles::make_tile(std::size_t node) {
  const auto row_size = static_cast<std::size_t>(side_);
  if (white_.empty()) {
    white_.resize((row_size / 2 + 1) * row_size);
    const WhiteNoiseRow keyed = keyed_white_noise(seed_, kSpectrumStream, side_);
    for (std::size_t v = 0; v <= row_size / 2; ++v) keyed(static_cast<int>(v), white_.data() + v * row_size);
  }
  const FbmEmbedding embedding = make_embedding(3.0 - (kFirst + kStep * static_cast<double>(node)), side_);
  const WhiteNoiseRow stored = [this, row_size](int v, std::complex<float>* row) {
    std::copy_n(white_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(v) * row_size), row_size, row);
  };
  tiles_[node] = {embedded_field(embedding, stored, side_, side_), embedding.plane_slope_sigma()};
}

void ResidualTiles::prepare(double dimension) {
  const Blend blend = blend_of(dimension);
  for (const std::size_t node : {blend.node, blend.node + 1})
    if (tiles_[node].field.empty()) make_tile(node);
}

void ResidualTiles::surface_row(double dimension, CellIndex start, CellIndex centre, int count, float* out) const {
  const Blend blend = blend_of(dimension);
  const Tile &below = tiles_[blend.node], &above = tiles_[blend.node + 1];
  const auto a = below.field.row(wrapped(start.y)), b = above.field.row(wrapped(start.y));
  const auto normals = random_normals(seed_, kPlaneStream, 0, 0);
  const double sigma = below.slope_sigma + static_cast<double>(blend.weight) * (above.slope_sigma - below.slope_sigma);
  const auto along = static_cast<float>(sigma * normals[0]);
  const auto offset =
      static_cast<float>(sigma * (normals[0] * (start.x - centre.x) + normals[1] * (start.y - centre.y)));
  auto x = static_cast<std::size_t>(wrapped(start.x));
  for (int i = 0; i < count; ++i) {
    out[i] = a[x] + blend.weight * (b[x] - a[x]) + (offset + along * static_cast<float>(i));
    if (++x == a.size()) x = 0;
  }
}

void ResidualTiles::noise_row(CellIndex start, int count, float* out) const {
  const auto row = noise_.row(wrapped(start.y));
  auto x = static_cast<std::size_t>(wrapped(start.x));
  for (int i = 0; i < count; ++i) {
    out[i] = row[x];
    if (++x == row.size()) x = 0;
  }
}

}  // namespace scree::fractal
