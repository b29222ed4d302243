#include "fractal/surface.hpp"

#include <cmath>
#include <fmt/format.h>

#include "core/random.hpp"
#include "fractal/fbm_embedding.hpp"

namespace scree::fractal {
namespace {

constexpr int kMaxSide = 20000;                                // torus cells a side: 0.8 GB of eigenvalues
constexpr std::uint64_t kSpectrumStream = 0x66626d2d73706563;  // "fbm-spec"
constexpr std::uint64_t kPlaneStream = 0x66626d2d706c616e;     // "fbm-plan"

Status check(const FractalLaw& law, int rows, int columns, double cell_m) {
  const auto usage = [](std::string message) { return Error{ErrorKind::usage, std::move(message)}; };
  if (!(law.dimension >= 2.05 && law.dimension <= 2.95))
    return usage(fmt::format("fBm surface: expected 2.05 <= D <= 2.95, found D = {}", law.dimension));
  if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
    return usage(fmt::format("fBm surface: expected a finite amplitude_m > 0, found {}", law.amplitude_m));
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return usage(fmt::format("fBm surface: expected a finite cell_m > 0, found {}", cell_m));
  if (rows < 1 || columns < 1)
    return usage(fmt::format("fBm surface: expected at least 1 x 1 cells, found {} x {}", rows, columns));
  const double reach = law.hurst() > 0.75 ? 4.0 : 2.0;
  if (reach * std::hypot(rows - 1, columns - 1) > kMaxSide)
    return usage(fmt::format("fBm surface: expected a diagonal of at most {} cells for D = {}, found {} x {} cells",
                             static_cast<int>(kMaxSide / reach), law.dimension, rows, columns));
  return {};
}

}  // namespace

double FractalLaw::rms_change_m(double lag_m) const {
  return amplitude_m * std::pow(lag_m, hurst());
}

double FractalLaw::rms_bend_m(double lag_m) const {
  return std::sqrt(4.0 - std::pow(4.0, hurst())) * rms_change_m(lag_m);
}

Result<Grid<float>> fbm_surface(const FractalLaw& law, int rows, int columns, double cell_m, std::uint64_t seed) {
  if (Status status = check(law, rows, columns, cell_m); !status) return status.error();
  const double hurst = law.hurst();
  const double diagonal_cells = std::max(2.0, std::hypot(rows - 1, columns - 1));
  const FbmEmbedding embedding = make_embedding(hurst, embedding_side(hurst, diagonal_cells));
  Grid<float> field =
      embedded_field(embedding, keyed_white_noise(seed, kSpectrumStream, embedding.side), rows, columns);

  const auto slopes = random_normals(seed, kPlaneStream, 0, 0);
  const double slope_x = slopes[0] * embedding.plane_slope_sigma();
  const double slope_y = slopes[1] * embedding.plane_slope_sigma();
  const double amplitude = law.rms_change_m(cell_m);
  const double origin = field(0, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      field(r, c) = static_cast<float>(amplitude * (field(r, c) - origin + slope_x * c + slope_y * r));
  return field;
}

}  // namespace scree::fractal
