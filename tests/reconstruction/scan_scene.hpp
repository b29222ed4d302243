#pragma once
// Exact ground seen by a scanner at a grazing angle: what it measures, and what its rays say of the ground they pass.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/random.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// Unit: the cell, 1 m. The scanner stands `kBehind` cells west of the map's western side, `kAbove` above its mean
/// height, and fans rays over the map, equally spaced in angles. The surface is bilinear between the cells' centres.
struct ScanScene {
  static constexpr double kBehind = 20.0, kAbove = 30.0, kRangeSigma = 0.1, kStep = 0.25;

  FractalLaw law;  ///< the one law, or the middle of `laws`
  LawMap laws;
  Grid<float> truth;
  CellSamples samples;
  Grid<float> ceiling_m;  ///< lowest ray over each cell that is not measured, NaN = none

  ScanScene(double dimension, double amplitude, int side, int azimuths, int elevations, std::uint64_t seed)
      : ScanScene({{dimension, amplitude}, {}, {}}, *fbm_surface({dimension, amplitude}, side, side, 1.0, seed),
                  azimuths, elevations, seed) {}

  ScanScene(const LawMap& of, Grid<float> ground, int azimuths, int elevations, std::uint64_t seed)
      : law(of.law), laws(of), truth(std::move(ground)) {
    const int side = truth.rows();
    double mean = 0.0;
    for (const float z : truth) mean += static_cast<double>(z) / static_cast<double>(truth.size());
    for (float& z : truth) z -= static_cast<float>(mean);
    ceiling_m.assign(side, side, std::numeric_limits<float>::quiet_NaN());
    HeightSamples points;
    for (int a = 0; a < azimuths; ++a)
      for (int e = 0; e < elevations; ++e) {
        const auto normals = random_normals(seed, 70, a, e);
        const double half = std::atan2(0.5 * side, kBehind);
        cast((2.0 * (a + 0.5) / azimuths - 1.0) * half, -0.01 - 0.8 * (e + 0.5) / elevations, normals[0], points);
      }
    samples = bin_samples(points, {side, side, 1.0}, laws);
    for (std::size_t i = 0; i < ceiling_m.size(); ++i)
      if (!std::isnan(samples.height_m[i])) ceiling_m[i] = std::numeric_limits<float>::quiet_NaN();
  }

  double height(double x, double y) const {
    const int n = truth.rows();
    const double u = std::clamp(x - 0.5, 0.0, n - 1.001), v = std::clamp(y - 0.5, 0.0, n - 1.001);
    const int c = static_cast<int>(u), r = static_cast<int>(v);
    const double fu = u - c, fv = v - r;
    const auto z = [&](int i, int j) { return static_cast<double>(truth(i, j)); };
    return (1 - fv) * ((1 - fu) * z(r, c) + fu * z(r, c + 1)) + fv * ((1 - fu) * z(r + 1, c) + fu * z(r + 1, c + 1));
  }

 private:
  void cast(double azimuth, double elevation, double normal, HeightSamples& points) {
    const int n = truth.rows();
    const double dx = std::cos(elevation) * std::cos(azimuth), dy = std::cos(elevation) * std::sin(azimuth);
    const double dz = std::sin(elevation);
    const auto x = [&](double t) { return -kBehind + dx * t; };
    const auto y = [&](double t) { return 0.5 * n + dy * t; };
    const auto z = [&](double t) { return kAbove + dz * t; };
    double t = (kBehind + 1e-9) / dx;
    if (z(t) < height(x(t), y(t))) return;  // below the map's western side
    for (; x(t) < n && y(t) > 0 && y(t) < n; t += kStep) {
      if (z(t) <= height(x(t), y(t))) break;
      // The ray where it passes the centre: at the cell's far side it may be lower than the ground in the middle is.
      const double column = std::floor(x(t)), row = std::floor(y(t));
      const double ahead = ((column + 0.5 - x(t)) * dx + (row + 0.5 - y(t)) * dy) / (dx * dx + dy * dy);
      if (std::abs(ahead) > 0.5 * kStep) continue;
      float& ceiling = ceiling_m(static_cast<int>(row), static_cast<int>(column));
      if (!(ceiling <= z(t + ahead))) ceiling = static_cast<float>(z(t + ahead));
    }
    if (!(x(t) < n && y(t) > 0 && y(t) < n)) return;
    double in = t, out = t - kStep;
    for (int k = 0; k < 30; ++k) {
      const double middle = 0.5 * (in + out);
      (z(middle) <= height(x(middle), y(middle)) ? in : out) = middle;
    }
    // What noise along the ray does across slopes the ground's own change over that distance tells.
    const FractalLaw here = laws.at(static_cast<int>(y(in)), static_cast<int>(x(in)));
    const double noise = here.rms_change_m(std::cos(elevation) * kRangeSigma);
    const double measured = in + kRangeSigma * normal;
    points.x_m.push_back(x(measured));
    points.y_m.push_back(y(measured));
    points.z_m.push_back(z(measured));
    points.variance_m2.push_back(std::pow(dz * kRangeSigma, 2) + noise * noise);
  }
};

}  // namespace scree::fractal
