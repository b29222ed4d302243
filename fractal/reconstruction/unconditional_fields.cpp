#include "fractal/reconstruction/unconditional_fields.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr int kMaxSide = 20000;                                // of the torus
constexpr std::uint64_t kSpectrumStream = 0x756e636f6e642d73;  // "uncond-s"
constexpr std::uint64_t kPlaneStream = 0x756e636f6e642d70;     // "uncond-p"

}  // namespace

int UnconditionalFields::max_diagonal(double hurst) {
  return kMaxSide / (hurst > 0.75 ? 4 : 2);
}

Result<UnconditionalFields> UnconditionalFields::make(double hurst, int rows, int columns) {
  if (!(hurst >= 0.05 && hurst <= 0.95))
    return Error{ErrorKind::usage, fmt::format("fBm: expected 2.05 <= D <= 2.95, found D = {}", 3.0 - hurst)};
  const double diagonal = std::max(2.0, std::hypot(rows - 1, columns - 1));
  if (diagonal > max_diagonal(hurst))
    return Error{ErrorKind::usage, fmt::format("fBm: expected a diagonal of at most {} cells for D = {}, found {} x {}",
                                               max_diagonal(hurst), 3.0 - hurst, rows, columns)};
  UnconditionalFields out;
  out.embedding_ = make_embedding(hurst, embedding_side(hurst, diagonal));
  out.rows_ = rows;
  out.columns_ = columns;
  return out;
}

Grid<float> UnconditionalFields::field(std::uint64_t seed, int k) const {
  Grid<float> field = embedded_field(
      embedding_, keyed_white_noise(seed, kSpectrumStream + static_cast<std::uint64_t>(k), embedding_.side), rows_,
      columns_);
  const auto slopes = random_normals(seed, kPlaneStream, k, 0);
  const double slope_x = slopes[0] * embedding_.plane_slope_sigma();
  const double slope_y = slopes[1] * embedding_.plane_slope_sigma();
  const double origin = static_cast<double>(field(0, 0));
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      field(r, c) = static_cast<float>(static_cast<double>(field(r, c)) - origin + slope_x * c + slope_y * r);
  return field;
}

}  // namespace scree::fractal
