#include "fractal/directional_hurst.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

/// Fewer complete triples than this at an offset say nothing.
constexpr double kMinTriples = 16.0;
/// Half-width of a sector, in azimuths: 30°. With 15° the windows of 21 cells have two or three offsets in a sector,
/// and V on isotropic ground is twice as large.
constexpr double kSectorAzimuths = 2.0;

struct OffsetEnergy {
  int dx = 0, dy = 0;
  double sum_m2 = 0.0, triples = 0.0;
};

/// Σ of squared second differences and their number along one row; z, m point at the first centre.
SCREE_CLONES void add_row(const float* z, const float* m, std::ptrdiff_t step, int n, double& sum, double& triples) {
  Lanes energy = {}, count = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    Lanes a, b, c, ma, mb, mc;
    std::memcpy(&a, z + i - step, sizeof a);
    std::memcpy(&b, z + i, sizeof b);
    std::memcpy(&c, z + i + step, sizeof c);
    std::memcpy(&ma, m + i - step, sizeof ma);
    std::memcpy(&mb, m + i, sizeof mb);
    std::memcpy(&mc, m + i + step, sizeof mc);
    const Lanes change = (a - b) + (c - b), weight = ma * mb * mc;
    energy += weight * (change * change);
    count += weight;
  }
  for (; i < n; ++i) {
    const float change = (z[i - step] - z[i]) + (z[i + step] - z[i]), weight = m[i - step] * m[i] * m[i + step];
    energy[i % 8] += weight * (change * change);
    count[i % 8] += weight;
  }
  for (int lane = 0; lane < 8; ++lane) {
    sum += static_cast<double>(energy[lane]);
    triples += static_cast<double>(count[lane]);
  }
}

void measure(const MaskedHeights& heights, int row_stride, OffsetEnergy& at) {
  const int margin = std::abs(at.dx), width = heights.columns - 2 * margin;
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(at.dy) * heights.stride() + at.dx;
  for (int r = at.dy; r < heights.rows - at.dy; r += row_stride) {
    const std::ptrdiff_t first = heights.offset(r, margin);
    add_row(heights.height.data() + first, heights.mask.data() + first, step, width, at.sum_m2, at.triples);
  }
}

/// The upper half plane: an offset and its opposite give the same triples.
std::vector<OffsetEnergy> offsets_up_to(int max_lag) {
  std::vector<OffsetEnergy> offsets;
  for (int dy = 0; dy <= max_lag; ++dy)
    for (int dx = -max_lag; dx <= max_lag; ++dx)
      if ((dy > 0 || dx > 0) && dx * dx + dy * dy <= max_lag * max_lag) offsets.push_back({dx, dy});
  return offsets;
}

/// Weighted line through (ln |o|, ln ratio).
struct Line {
  double w = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  void add(double weight, double px, double py) {
    w += weight, x += weight * px, y += weight * py, xx += weight * px * px, xy += weight * px * py;
  }
  double slope() const {
    const double spread = xx - x * x / w;
    return w > 0.0 && spread > 1e-6 * w ? (xy - x * y / w) / spread : std::numeric_limits<double>::quiet_NaN();
  }
};

double expected_energy(const IsotropicLaw& law, int dx, int dy) {
  const auto gamma = [&](int k) { return mean_variogram(law.support, law.hurst, k * dx, k * dy); };
  return law.c_m2 * (4.0 * gamma(1) - gamma(2) - 3.0 * gamma(0));
}

/// One offset's energy over what the isotropic law expects.
struct Ratio {
  double weight, log_lag, log_ratio, angle_rad;
};

std::vector<Ratio> ratios(const std::vector<OffsetEnergy>& offsets, const IsotropicLaw& law) {
  std::vector<Ratio> out;
  for (const OffsetEnergy& at : offsets) {
    if (at.triples < kMinTriples) continue;
    const double mean = at.sum_m2 / at.triples, energy = mean - 6.0 * law.noise_m2;
    if (!(energy > 0.0)) continue;
    const double lag = std::hypot(at.dx, at.dy), share = energy / mean;  // what noise takes away it makes uncertain
    out.push_back({share * share * at.triples / (lag * lag * lag), std::log(lag),
                   std::log(energy / expected_energy(law, at.dx, at.dy)), std::atan2(at.dy, at.dx)});
  }
  return out;
}

/// Takes what depends on the angle alone off the logarithms: a + b·ln |o| + two harmonics, by weighted least squares.
/// Within a sector the angles on a lattice change with the length, and C(θ) would pass for a slope.
void remove_amplitude_by_angle(std::vector<Ratio>& ratios) {
  constexpr int kTerms = 6;
  using Terms = Eigen::Matrix<double, kTerms, 1>;
  const auto terms = [](const Ratio& r) {
    Terms t;
    t << 1.0, r.log_lag, std::cos(2.0 * r.angle_rad), std::sin(2.0 * r.angle_rad), std::cos(4.0 * r.angle_rad),
        std::sin(4.0 * r.angle_rad);
    return t;
  };
  Eigen::Matrix<double, kTerms, kTerms> normal = decltype(normal)::Zero();
  Terms right = Terms::Zero();
  for (const Ratio& r : ratios) {
    const Terms t = terms(r);
    normal += r.weight * t * t.transpose();
    right += r.weight * r.log_ratio * t;
  }
  const Eigen::LDLT<decltype(normal)> factor(normal);
  if (ratios.size() < 2 * kTerms || !(factor.rcond() > 1e-9)) return;
  Terms fit = factor.solve(right);
  fit.head<2>().setZero();  // level and slope stay
  for (Ratio& r : ratios) r.log_ratio -= fit.dot(terms(r));
}

std::array<Line, kAzimuthCount> azimuth_lines(const std::vector<Ratio>& ratios) {
  std::array<Line, kAzimuthCount> lines;
  for (const Ratio& r : ratios) {
    const double azimuth = r.angle_rad * (kAzimuthCount / std::numbers::pi);
    for (int i = 0; i < kAzimuthCount; ++i) {
      const double apart = std::abs(azimuth - i);
      const double nearness = 1.0 - std::min(apart, kAzimuthCount - apart) / kSectorAzimuths;
      if (nearness > 0.0) lines[static_cast<std::size_t>(i)].add(nearness * r.weight, r.log_lag, r.log_ratio);
    }
  }
  return lines;
}

}  // namespace

int azimuth_lag_cells(int rows, int columns, double known_cells) {
  const double side = std::min({static_cast<double>(rows), static_cast<double>(columns), std::sqrt(known_cells)});
  return std::min(kMaxAzimuthLag_cells, static_cast<int>(side / 4.0));
}

DirectionalHurst directional_hurst(const MaskedHeights& heights, const IsotropicLaw& law, int max_lag_cells,
                                   Executor& executor) {
  DirectionalHurst out;
  out.hurst.fill(std::numeric_limits<double>::quiet_NaN());
  out.max_lag_cells = max_lag_cells;
  if (max_lag_cells < kMinAzimuthLag_cells) return out;
  std::vector<OffsetEnergy> offsets = offsets_up_to(max_lag_cells);
  const auto cells = static_cast<std::size_t>(heights.rows) * static_cast<std::size_t>(heights.columns);
  const int row_stride = 1 + static_cast<int>(cells >> 18);
  executor.for_ranges(static_cast<int>(offsets.size()), [&](int begin, int end) {
    for (int i = begin; i < end; ++i) measure(heights, row_stride, offsets[static_cast<std::size_t>(i)]);
  });
  std::vector<Ratio> log_ratios = ratios(offsets, law);
  remove_amplitude_by_angle(log_ratios);
  const auto lines = azimuth_lines(log_ratios);
  double sum = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) sum += out.hurst[i] = law.hurst + 0.5 * lines[i].slope();
  const auto [low, high] = std::minmax_element(out.hurst.begin(), out.hurst.end());
  if (sum > 0.0) out.index_v = (*high - *low) / (sum / kAzimuthCount);  // NaN when an azimuth is
  return out;
}

}  // namespace scree::fractal
