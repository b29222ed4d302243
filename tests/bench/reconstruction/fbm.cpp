// Exact fBm against a periodic synthesis of the same size with the same transform.

#include <cmath>

#include "core/random.hpp"
#include "fractal/fbm_embedding.hpp"
#include "fractal/surface.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

/// The usual spectral synthesis: white noise times k^−(1+H) on a torus of the size of the grid. Hermitian half only,
/// the same generator of normals, the same transforms as the exact one; what differs is the torus and its spectrum.
Grid<float> periodic_surface(double hurst, int side, std::uint64_t seed) {
  FbmEmbedding spectrum;
  spectrum.hurst = hurst;
  spectrum.side = side;
  spectrum.unit_cells = 1.0;
  const int n = side / 2 + 1;
  spectrum.eigenvalues.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int v = 0; v < n; ++v)
    for (int u = 0; u < n; ++u)
      spectrum.eigenvalues[static_cast<std::size_t>(v) * static_cast<std::size_t>(n) + static_cast<std::size_t>(u)] =
          u + v == 0 ? 0.0 : std::pow(static_cast<double>(u) * u + static_cast<double>(v) * v, -1.0 - hurst);
  return embedded_field(spectrum, keyed_white_noise(seed, 1, side), side, side);
}

}  // namespace

void fbm_section() {
  print_text(R"(
## Exact fBm against a periodic synthesis

CPU of one thread, best of two runs in turn. Periodic: white noise times k^−(1+H) on the N × N torus, which has neither
the law of fBm nor ground that differs from edge to opposite edge. Exact: Stein's embedding on a torus of twice the
diagonal (H ≤ .75; four times above).

| N | H | torus | periodic, s | exact, s | ratio | target ≤ 15 |
|---|---|---|---|---|---|---|)");
  for (const int side : quick ? std::vector{512, 1024} : std::vector{512, 1024, 2048, 4096})
    for (const double hurst : {0.3, 0.7}) {
      double periodic = 1e300, exact = 1e300;
      for (int round = 0; round < 2; ++round) {
        periodic = std::min(periodic, timed([&] { periodic_surface(hurst, side, 1); }).cpu_ms);
        exact = std::min(exact, timed([&] { (void)fbm_surface({3.0 - hurst, 1.0}, side, side, 1.0, 1); }).cpu_ms);
      }
      print_text(fmt::format("| {} | {} | {} | {:.2f} | {:.2f} | {:.1f} | {} |", side, hurst,
                             embedding_side(hurst, std::hypot(side - 1, side - 1)), periodic / 1e3, exact / 1e3,
                             exact / periodic, at_most(exact / periodic, 15.0)));
    }
}

}  // namespace scree::bench
