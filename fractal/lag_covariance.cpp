#include "fractal/lag_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree::fractal {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLongestWave = 0.2;  // lowest frequency, in units of π/side
// Waves are damped as if the survey were this much narrower: the one constant of the covariance that is fitted (to
// simulated surfaces). It stands for what a formula for endless surveys leaves out at the edges. What users of the
// covariance chose on simulated surfaces too: the ridges of lag_fit.cpp, the smoothest weights, the charges of
// scale_laws.cpp.
constexpr double kPlaneReach = 0.75;
constexpr int kLevelCells = 12;  // nodes along an axis of a dyadic square of frequencies
constexpr int kPlaneNodes = 180;
constexpr double kHighest = 60.0;       // highest frequency in the plane, over the shortest lag
constexpr double kExactOffsets = 48.0;  // cells: annuli up to here are summed offset by offset
constexpr int kAliases = 3;
constexpr int kAngles = 16;

/// Share of the power of increments of a wave that is left above the least-squares line of a segment that spans
/// 2y/(2π) of its lengths.
double above_plane(double y) {
  if (y < 0.05) return y * y / 3.0;
  const double j0 = std::sin(y) / y, j1 = (j0 - std::cos(y)) / y;
  return 1.0 - 6.0 * j0 * j1 / y + 9.0 * j1 * j1 / (y * y);
}

/// 2·(1 − mean of cos over an annulus).
double annulus_symbol(double inner, double outer, double omega) {
  if (omega * outer < 0.05) return 0.25 * omega * omega * (inner * inner + outer * outer);
  const double mean =
      2.0 * (outer * ::j1(omega * outer) - inner * ::j1(omega * inner)) / (omega * (outer * outer - inner * inner));
  return 2.0 * (1.0 - mean);
}

}  // namespace

void LagModel::Nodes::add(double x, double y, double w) {
  omega_x.push_back(x);
  omega_y.push_back(y);
  weight.push_back(w);
}

LagModel::LagModel(const LagStatistics& statistics) : statistics_(statistics), plane_(statistics) {
  const double cell = statistics.cell;
  std::vector<Offsets> offsets;
  if (cell > 0.0) {
    place_lattice_nodes();
    for (const Lag& lag : statistics.lags) offsets.push_back(offsets_of(lag, cell));
  } else {
    place_plane_nodes();
  }
  const auto count = static_cast<Eigen::Index>(nodes_.weight.size());
  symbols_.resize(count, lags());
  std::vector<double> cos_x(static_cast<std::size_t>(kExactOffsets) + 2), cos_y(cos_x.size());
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto at = static_cast<std::size_t>(n);
    const double x = nodes_.omega_x[at], y = nodes_.omega_y[at], omega = std::hypot(x, y);
    const double left = std::sqrt(nodes_.weight[at]) * above_plane(kPlaneReach * 0.5 * statistics.side * omega);
    const double sharp = std::exp(-statistics.blur * statistics.blur * omega * omega);
    for (std::size_t k = 0; k < cos_x.size() && cell > 0.0; ++k)
      cos_x[k] = std::cos(static_cast<double>(k) * cell * x), cos_y[k] = std::cos(static_cast<double>(k) * cell * y);
    for (Eigen::Index l = 0; l < lags(); ++l) {
      const auto lag = static_cast<std::size_t>(l);
      const auto& annulus = statistics.lags[lag];
      const bool exact = cell > 0.0 && !offsets[lag].quadrant.empty();
      const double symbol =
          exact ? lattice_symbol(offsets[lag], cos_x, cos_y) : annulus_symbol(annulus.inner, annulus.outer, omega);
      symbols_(n, l) = left * (2.0 + (symbol - 2.0) * sharp);
    }
  }
}

/// None where they are so many that their mean is that of the whole annulus.
LagModel::Offsets LagModel::offsets_of(const Lag& lag, double cell) {
  Offsets out;
  if (lag.outer > kExactOffsets * cell) return out;
  const int reach = static_cast<int>(lag.outer / cell) + 1;
  for (int y = 0; y <= reach; ++y)
    for (int x = 0; x <= reach; ++x) {
      const double d = cell * std::hypot(x, y);
      if (d < lag.inner || d >= lag.outer) continue;
      const double images = (x > 0 ? 2.0 : 1.0) * (y > 0 ? 2.0 : 1.0);
      out.quadrant.push_back({static_cast<std::size_t>(x), static_cast<std::size_t>(y), images});
      out.count += images;
    }
  return out;
}

/// Squares of half the size each, down to waves that are longer than the survey; an eighth of each.
void LagModel::place_lattice_nodes() {
  const double area = statistics_.side * statistics_.side, lowest = kLongestWave * kPi / statistics_.side;
  double half = kPi / statistics_.cell;
  for (bool last = false; !last; half *= 0.5) {
    last = half < lowest;
    const double step = half / kLevelCells;
    for (int i = 0; i < kLevelCells; ++i)
      for (int k = 0; k <= i; ++k) {
        if (!last && i < kLevelCells / 2) continue;  // the next square's
        const double images = i == k ? 4.0 : 8.0;
        nodes_.add((i + 0.5) * step, (k + 0.5) * step, images * step * step * 2.0 / (4.0 * kPi * kPi * area));
      }
  }
}

/// Rings evenly spaced in log frequency.
void LagModel::place_plane_nodes() {
  const double area = statistics_.side * statistics_.side, lowest = kLongestWave * kPi / statistics_.side;
  const double highest = kHighest / statistics_.lags.front().distance;
  const double step = std::log(highest / lowest) / kPlaneNodes;
  for (int i = 0; i < kPlaneNodes; ++i) {
    const double omega = lowest * std::exp(step * (i + 0.5));
    nodes_.add(omega, 0.0, 2.0 * kPi * omega * omega * step * 2.0 / (4.0 * kPi * kPi * area));
  }
}

/// 2·(1 − mean of cos ω·u) over the offsets of an annulus of a lattice; cosines of multiples of ω are given.
double LagModel::lattice_symbol(const Offsets& offsets, std::span<const double> cos_x, std::span<const double> cos_y) {
  double sum = 0.0;
  for (const auto& [x, y, images] : offsets.quadrant) sum += images * cos_x[x] * cos_y[y];
  return 2.0 * (1.0 - sum / offsets.count);
}

/// f and its aliases; those far away are an integral over the rest of the plane.
double LagModel::folded_spectrum(const GroundLaw& law, double omega_x, double omega_y) const {
  const double cell = statistics_.cell;
  if (cell <= 0.0) return law.spectrum(std::hypot(omega_x, omega_y));
  const double period = 2.0 * kPi / cell;
  double sum = 0.0;
  for (int y = -kAliases; y <= kAliases; ++y)
    for (int x = -kAliases; x <= kAliases; ++x)
      sum += law.spectrum(std::hypot(omega_x + x * period, omega_y + y * period));
  return sum;
}

/// At the distances that PlaneLoss wants.
Eigen::VectorXd LagModel::variogram(const GroundLaw& law) const {
  Eigen::VectorXd out(plane_.distances.size());
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = law.variogram(plane_.distances[i]);
  return out;
}

/// Horizontal noise turns the slope of the plane into noise of heights: that of the plane that was found counts, while
/// the blur of the law holds that of the plane that the law expects.
double LagModel::slope_excess(const Eigen::VectorXd& variogram) const {
  return statistics_.slope_noise - statistics_.blur * statistics_.blur * plane_.slope.dot(variogram);
}

Eigen::VectorXd LagModel::expected(const GroundLaw& law) const {
  const Eigen::VectorXd change = variogram(law);
  Eigen::VectorXd out = (plane_.weights * change).array() + 2.0 * slope_excess(change);
  for (Eigen::Index l = 0; l < lags(); ++l) {
    const Lag& lag = statistics_.lags[static_cast<std::size_t>(l)];
    const double apart = std::exp(lag.spread);  // the mean over the annulus to third order in its width
    const double own = 0.5 * (law.variogram(lag.distance * apart) + law.variogram(lag.distance / apart));
    out[l] = std::max(own + out[l], 1e-3 * own) + 2.0 * law.noise_variance;
  }
  return out;
}

Eigen::MatrixXd LagModel::covariance(const GroundLaw& law) const {
  Eigen::VectorXd spectra(symbols_.rows());
  const double white = std::max(0.0, law.white_variance() + slope_excess(variogram(law)));
  // Aliases beyond those that are summed: at no frequency more than a few percent of f.
  double far = 0.0;
  if (statistics_.cell > 0.0) {
    const double edge = (2 * kAliases + 1) * 2.0 * std::sqrt(kPi) / statistics_.cell;  // of the disc of equal area
    for (double omega = edge * 1.1; omega < 1e4 * edge; omega *= 1.21)
      far += law.spectrum(omega) * omega * omega * std::log(1.21) * 2.0 * kPi;
    far *= statistics_.cell * statistics_.cell / (4.0 * kPi * kPi);
    far += white * statistics_.cell * statistics_.cell;
  }
  for (Eigen::Index n = 0; n < spectra.size(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    spectra[n] = folded_spectrum(law, nodes_.omega_x[at], nodes_.omega_y[at]) + far;
  }
  const Eigen::MatrixXd shaped = spectra.asDiagonal() * symbols_;
  Eigen::MatrixXd out = shaped.transpose() * shaped;
  add_shared_points(law, white, out);
  const Eigen::VectorXd inverse = expected(law).cwiseInverse();
  return inverse.asDiagonal() * out * inverse.asDiagonal();
}

void LagModel::add_shared_points(const GroundLaw& law, double white, Eigen::MatrixXd& covariance) const {
  const double gaps = 1.0 - statistics_.fill;
  if (gaps <= 0.0) return;
  const double at_zero = law.variogram(0.0);
  const auto& all = statistics_.lags;
  for (Eigen::Index l = 0; l < lags(); ++l)
    for (Eigen::Index m = 0; m <= l; ++m) {
      const Lag &a = all[static_cast<std::size_t>(l)], &b = all[static_cast<std::size_t>(m)];
      const double ends = law.variogram(a.distance) + law.variogram(b.distance) - 2.0 * at_zero;
      double mean = 0.0;
      for (int k = 0; k < kAngles; ++k) {
        const double between = std::sqrt(a.distance * a.distance + b.distance * b.distance -
                                         2.0 * a.distance * b.distance * std::cos((k + 0.5) * kPi / kAngles));
        const double c = 0.5 * (ends - law.variogram(between) + at_zero) + white;
        mean += c * c / kAngles;
      }
      const double shared = gaps * 8.0 / std::max(a.points, b.points) * mean;
      covariance(l, m) += shared;
      if (l != m) {
        covariance(m, l) += shared;
        continue;
      }
      const double total = law.variogram(a.distance) + 2.0 * law.noise_variance;
      covariance(l, l) += (1.0 - statistics_.fill * statistics_.fill) * 2.0 * total * total / a.pairs;
    }
}

}  // namespace scree::fractal
