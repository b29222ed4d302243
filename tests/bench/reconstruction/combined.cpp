// The four terrains of [X09], their index V, and the statistic that answers the question.

#include <array>

#include "fractal/anisotropy.hpp"
#include "fractal/combined_surface.hpp"
#include "fractal/midpoint_displacement.hpp"
#include "fractal/surface.hpp"
#include "tests/bench/reconstruction/report.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr int kSide = 1024;
constexpr double kCellM = 2.0;

struct Terrain {
  std::string name, published;
  std::function<Grid<float>(std::uint64_t seed)> make;
};

Anisotropy analysed(const Grid<float>& surface) {
  SerialExecutor serial;
  const Grid<float> noise(surface.rows(), surface.columns(), 0.0F);
  const Grid<std::uint16_t> hits(surface.rows(), surface.columns(), 0);
  return *analyse_anisotropy(surface, kCellM, noise, hits, serial);
}

/// A window in the middle.
Grid<float> window(const Grid<float>& surface, int side) {
  Grid<float> part(side, side);
  const int from = (surface.rows() - side) / 2;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) part(r, c) = surface(from + r, from + c);
  return part;
}

void rows_of(const Terrain& terrain, int count) {
  const std::vector<std::array<Anisotropy, 2>> found = over_surfaces(surfaces(count), [&](int i) {
    const Grid<float> surface = terrain.make(static_cast<std::uint64_t>(i));
    return std::array{analysed(surface), analysed(window(surface, 41))};
  });
  std::string line = fmt::format("| {} | {} |", terrain.name, terrain.published);
  for (std::size_t w = 0; w < 2; ++w) {
    double v = 0.0, v2 = 0.0, null = 0.0, over_half = 0.0, v_significant = 0.0, chi = 0.0, significant = 0.0;
    const auto n = static_cast<double>(found.size());
    for (const auto& both : found) {
      const Anisotropy& a = both[w];
      v += a.index_v / n, v2 += a.index_v * a.index_v / n, null += a.index_v_null95 / n, chi += a.chi_square / n;
      over_half += (a.index_v > 0.5) / n, v_significant += a.v_significant / n, significant += a.significant / n;
    }
    line += fmt::format(" {:.3f} ± {:.3f} ({:.3f}) | {:.2f} | {:.2f} | {:.3g} | {:.2f} |", v,
                        std::sqrt(std::max(0.0, v2 - v * v)), null, over_half, v_significant, chi, significant);
  }
  print_text(line);
}

}  // namespace

void combined_section() {
  print_text(R"(
## Combined fractal Brown surfaces

The terrains of Xia, Zhou and Yao: 1024 × 1024 heights, 20 surfaces each; the whole surface, then its middle 41 × 41. Per
window: V, mean ± sd over the surfaces (95 % quantile on isotropic ground); how often V > .5 (their criterion), V beyond
its quantile, the contrast statistic T (mean; 4 on isotropic ground) and how often it is significant at 5 %.

| terrain | V published | V, whole | > .5 | > null | T | significant | V, 41 × 41 | > .5 | > null | T | significant |
|---|---|---|---|---|---|---|---|---|---|---|---|)");
  const auto midpoint = [](double hurst) {
    return [hurst](std::uint64_t seed) {
      return *midpoint_displacement_triangles({3.0 - hurst, 1.0}, kSide, kSide, kCellM, seed);
    };
  };
  const auto exact = [](double hurst) {
    return [hurst](std::uint64_t seed) { return *fbm_surface({3.0 - hurst, 1.0}, kSide, kSide, kCellM, seed); };
  };
  const auto combined = [](double hx, double hy, double correlation) {
    return [=](std::uint64_t seed) {
      return *combined_surface({hx, hy, 0.5, correlation, 1.0}, kSide, kSide, kCellM, seed);
    };
  };
  rows_of({"1: midpoints of triangles, H = .35", ".254", midpoint(0.35)}, 20);
  rows_of({"2: midpoints of triangles, H = .7", ".239", midpoint(0.7)}, 20);
  rows_of({"1 as exact fBm", "", exact(0.35)}, 20);
  rows_of({"2 as exact fBm", "", exact(0.7)}, 20);
  rows_of({"3: combined .3, .6, ρ = .8", ".774", combined(0.3, 0.6, 0.8)}, 20);
  rows_of({"4: combined .4, .8, ρ = .8", ".681", combined(0.4, 0.8, 0.8)}, 20);
  rows_of({"3 with ρ = 0", "", combined(0.3, 0.6, 0.0)}, 20);
  rows_of({"4 with ρ = 0", "", combined(0.4, 0.8, 0.0)}, 20);
}

}  // namespace scree::bench
