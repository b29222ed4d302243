#include "fractal/reconstruction/residual_tile.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "core/simd.hpp"
#include "fractal/fbm_embedding.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kSpectrumStream = 0x7265732d73706563;  // "res-spec"
constexpr std::uint64_t kPlaneStream = 0x7265732d706c616e;     // "res-plan"
constexpr std::uint64_t kNoiseStream = 0x7265732d6e6f6973;     // "res-nois"

SCREE_CLONES void blend_piece(const float* __restrict a, const float* __restrict b, float weight, float level,
                              float along, int n, float* __restrict out) {
  for (int i = 0; i < n; ++i) out[i] = a[i] + weight * (b[i] - a[i]) + (level + along * static_cast<float>(i));
}

}  // namespace

ResidualTiles::ResidualTiles(std::uint64_t seed, int side) : seed_(seed), side_(side) {}

void ResidualTiles::make_noise(std::size_t part) {
  Grid<float>& noise = parts_[part].noise;
  noise.assign(side_, side_, 0.0F);
  for (int y = 0; y < side_; ++y)
    for (int x = 0; x < side_; x += 2) {
      const auto normals = random_normals(seed_, kNoiseStream + (part << 56), x, y);
      noise(y, x) = static_cast<float>(normals[0]);
      if (x + 1 < side_) noise(y, x + 1) = static_cast<float>(normals[1]);
    }
}

ResidualTiles::Blend ResidualTiles::blend_of(double dimension) {
  const double position = std::clamp((dimension - kFirst) / kStep, 0.0, static_cast<double>(kTiles - 1));
  const auto node = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kTiles - 2));
  return {node, static_cast<float>(position - static_cast<double>(node))};
}

void ResidualTiles::make_tile(std::size_t part, std::size_t node) {
  const auto row_size = static_cast<std::size_t>(side_);
  std::vector<std::complex<float>>& white = parts_[part].white;
  if (white.empty()) {
    white.resize((row_size / 2 + 1) * row_size);
    const WhiteNoiseRow keyed = keyed_white_noise(seed_, kSpectrumStream + (part << 56), side_);
    for (std::size_t v = 0; v <= row_size / 2; ++v) keyed(static_cast<int>(v), white.data() + v * row_size);
  }
  const FbmEmbedding embedding = make_embedding(3.0 - (kFirst + kStep * static_cast<double>(node)), side_);
  const WhiteNoiseRow stored = [&white, row_size](int v, std::complex<float>* row) {
    std::copy_n(white.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(v) * row_size), row_size, row);
  };
  parts_[part].tiles[node] = {embedded_field(embedding, stored, side_, side_), embedding.plane_slope_sigma()};
}

void ResidualTiles::prepare_noise(int fields) {
  for (int k = 0; k < fields; ++k) {
    const std::size_t part = part_of(k);
    if (part >= parts_.size()) parts_.resize(part + 1);
    if (parts_[part].noise.empty()) make_noise(part);
  }
}

void ResidualTiles::prepare(double dimension, int fields) {
  prepare_noise(fields);
  const Blend blend = blend_of(dimension);
  for (int k = 0; k < fields; ++k)
    for (const std::size_t node : {blend.node, blend.node + 1})
      if (parts_[part_of(k)].tiles[node].field.empty()) make_tile(part_of(k), node);
}

void ResidualTiles::surface_row(double dimension, int k, CellIndex start, CellIndex centre, int count,
                                float* out) const {
  const Blend blend = blend_of(dimension);
  const Part& part = parts_[part_of(k)];
  const Tile &below = part.tiles[blend.node], &above = part.tiles[blend.node + 1];
  const CellIndex from = shifted(k, start);
  const auto a = below.field.row(wrapped(from.y)), b = above.field.row(wrapped(from.y));
  const auto normals = random_normals(seed_, kPlaneStream, k, 0);
  const double sigma = below.slope_sigma + static_cast<double>(blend.weight) * (above.slope_sigma - below.slope_sigma);
  const auto along = static_cast<float>(sigma * normals[0]);
  const auto offset =
      static_cast<float>(sigma * (normals[0] * (start.x - centre.x) + normals[1] * (start.y - centre.y)));
  auto x = static_cast<std::size_t>(wrapped(from.x));
  for (int done = 0; done < count;) {  // piece by piece, as the torus wraps around
    const int piece = std::min(count - done, static_cast<int>(a.size() - x));
    blend_piece(a.data() + x, b.data() + x, blend.weight, offset + along * static_cast<float>(done), along, piece,
                out + done);
    done += piece;
    x = 0;
  }
}

void ResidualTiles::noise_row(int k, CellIndex start, int count, float* out) const {
  const CellIndex from = shifted(k, start);
  const auto row = parts_[part_of(k)].noise.row(wrapped(from.y));
  auto x = static_cast<std::size_t>(wrapped(from.x));
  for (int done = 0; done < count;) {
    const int piece = std::min(count - done, static_cast<int>(row.size() - x));
    std::copy_n(row.data() + x, piece, out + done);
    done += piece;
    x = 0;
  }
}

}  // namespace scree::fractal
