#include "drivers/simulator_physics.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/random.hpp"

namespace scree::drivers {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kLeastSignal = 1e-6;  // of reflectance · cos: a surface seen edge-on returns next to nothing
constexpr double kPulse_m = 0.3;       // echoes closer than this are one (about 2 ns) …
constexpr double kPulseRatio = 0.02;   // … or than this share of the range: slanted ground under one beam
constexpr double kStereoRatio = 0.05;  // a patch that slants by more cannot be matched

constexpr std::uint64_t kTextureStream = 0x7465787475726500;
constexpr std::uint64_t kDriftStream = 0x6472696674000000;

double signal(const BeamEcho& echo) {
  return std::max(echo.reflectance * echo.cos_incidence, kLeastSignal);
}

double crosstalk_at(const std::vector<double>& table, double reflectance) {
  if (table.empty()) return 0.0;
  if (table.size() == 1) return table[0];
  const double place = std::clamp(reflectance, 0.0, 1.0) * static_cast<double>(table.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), table.size() - 2);
  return std::lerp(table[i], table[i + 1], place - static_cast<double>(i));
}

/// Phase of the summed returns. Noise is added to the phasor, not to the range, so that
/// σ_range = nominal_sigma_m for a strong signal and the range is uniformly random for none.
BeamReading read_phase(const SensorPhysics& physics, double ambiguity_m, std::span<const BeamEcho> echoes, int parts,
                       const std::array<double, 4>& normals) {
  const double radians_per_m = kTwoPi / ambiguity_m;
  std::complex<double> phasor = 0.0;
  double power = 0.0;
  for (const BeamEcho& echo : echoes) {
    if (echo.range_m > physics.max_range_m) continue;
    const double strength = signal(echo) / (echo.range_m * echo.range_m) / parts;
    phasor += std::polar(strength, radians_per_m * echo.range_m);
    power += strength;
  }
  const double shot = physics.shot_per_m * radians_per_m, thermal = physics.thermal_per_m2 * radians_per_m;
  const double sigma = std::sqrt(shot * shot * power + thermal * thermal);
  if (power == 0.0 && sigma == 0.0) phasor = std::polar(1e-12, normals[0] * kTwoPi * 8.0);  // no thermal noise at all
  phasor += sigma * std::complex<double>(normals[0], normals[1]);
  double range = std::arg(phasor) / radians_per_m + physics.jitter_m * normals[2];
  range -= ambiguity_m * std::floor(range / ambiguity_m);
  // The sensor normalises by its own range; without a surface that is random too, and the reflectance is low.
  const double nearest = echoes.empty() ? 0.0 : echoes.front().range_m;
  return {range, std::abs(phasor) * nearest * nearest};
}

/// Mean of the strongest chain of echoes with gaps of at most `gap(range)`, weighted by `weight`.
template <class Weight, class Gap>
BeamEcho strongest_group(std::vector<BeamEcho>& echoes, const Weight& weight, const Gap& gap, double& total) {
  std::sort(echoes.begin(), echoes.end(), [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  BeamEcho best;
  total = 0.0;
  for (std::size_t begin = 0; begin < echoes.size();) {
    BeamEcho mean{0.0, 0.0, 0.0};
    double sum = 0.0;
    std::size_t i = begin;
    for (; i == begin || (i < echoes.size() && echoes[i].range_m - echoes[i - 1].range_m <= gap(echoes[i].range_m));
         ++i) {
      const double w = weight(echoes[i]);
      sum += w;
      mean.range_m += w * echoes[i].range_m;
      mean.cos_incidence += w * echoes[i].cos_incidence;
      mean.reflectance += w * echoes[i].reflectance;
    }
    if (sum > total) {
      total = sum;
      best = {mean.range_m / sum, mean.cos_incidence / sum, mean.reflectance / sum};
    }
    begin = i;
  }
  return best;
}

std::optional<BeamReading> read_group(const SensorPhysics& physics, std::span<const BeamEcho> echoes, int parts,
                                      const std::array<double, 4>& normals) {
  thread_local std::vector<BeamEcho> near;
  near.clear();
  for (const BeamEcho& echo : echoes)
    if (echo.range_m <= physics.max_range_m) near.push_back(echo);
  if (near.empty()) return std::nullopt;
  double total = 0.0;
  BeamEcho group;
  if (physics.principle == RangePrinciple::pulse) {
    group = strongest_group(
        near, [](const BeamEcho& e) { return signal(e) / (e.range_m * e.range_m); },
        [](double range) { return std::max(kPulse_m, kPulseRatio * range); }, total);
  } else {
    group = strongest_group(
        near, [](const BeamEcho&) { return 1.0; }, [](double range) { return kStereoRatio * range; }, total);
    if (2.0 * total < parts) return std::nullopt;
  }
  const double sigma = nominal_sigma_m(physics, group.range_m, group.reflectance, group.cos_incidence);
  return BeamReading{group.range_m + sigma * normals[0], std::max(0.0, signal(group))};
}

}  // namespace

double nominal_sigma_m(const SensorPhysics& physics, double range_m, double reflectance, double cos_incidence) {
  const double s =
      physics.principle == RangePrinciple::stereo ? 1.0 : std::max(reflectance * cos_incidence, kLeastSignal);
  const double shot = physics.shot_per_m * range_m, thermal = physics.thermal_per_m2 * range_m * range_m / s;
  return std::sqrt(physics.jitter_m * physics.jitter_m + shot * shot / s + thermal * thermal);
}

std::optional<BeamReading> read_beam(const SensorPhysics& physics, double ambiguity_m, std::span<const BeamEcho> echoes,
                                     int parts, const std::array<double, 4>& normals) {
  std::optional<BeamReading> reading = physics.principle == RangePrinciple::phase
                                           ? read_phase(physics, ambiguity_m, echoes, parts, normals)
                                           : read_group(physics, echoes, parts, normals);
  if (reading) reading->range_m += crosstalk_at(physics.crosstalk_m, reading->reflectance);
  return reading;
}

double ground_reflectance(const SensorPhysics& physics, std::uint64_t seed, double x_m, double y_m) {
  const double u = x_m / physics.texture_m, v = y_m / physics.texture_m;
  const double column = std::floor(u), row = std::floor(v);
  const auto at = [&](int dx, int dy) {
    return to_uniform(random_words(seed, kTextureStream, static_cast<std::int32_t>(column) + dx,
                                   static_cast<std::int32_t>(row) + dy)[0]);
  };
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double s = smooth(u - column), t = smooth(v - row);
  const double noise = std::lerp(std::lerp(at(0, 0), at(1, 0), s), std::lerp(at(0, 1), at(1, 1), s), t);
  return std::clamp(physics.reflectance * (1.0 + physics.reflectance_texture * (2.0 * noise - 1.0)), 0.0, 1.0);
}

double drift_offset_m(const SensorPhysics& physics, std::uint64_t seed, double t_s) {
  if (physics.drift_m == 0.0) return 0.0;
  const double start = to_uniform(random_words(seed, kDriftStream, 0, 0)[0]);
  return physics.drift_m * std::sin(kTwoPi * (t_s / physics.drift_period_s + start));
}

}  // namespace scree::drivers
