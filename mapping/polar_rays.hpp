#pragma once
// The rays of one sensor position in polar bins: what they say of the ground that they did not hit.

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/executor.hpp"

namespace scree::mapping {

/// Pseudo-angle in [0, 4) that grows with the azimuth of (x, y); cheaper than atan2, at most a factor 2 uneven.
inline float diamond_angle(float x, float y) {
  const float p = y / (std::abs(x) + std::abs(y));
  const float half = x < 0.0F ? 2.0F - p : p;
  return half < 0.0F ? half + 4.0F : half;
}

struct PolarConfig {
  float cell_m = 0.1F;
  int bins = 800;            ///< azimuths around the circle
  int rings = 200;           ///< distances, one cell each; the last ring holds everything farther
  float max_descent = 0.5F;  ///< steepest downhill (rise over run) along which ground is expected to go on
  float lip_reach_m = 3.0F;  ///< beyond this far behind a return nothing is expected of the ground
};

/// What the rays of one bin say at one ring, heights relative to the sensor.
struct RaySight {
  float ceiling_slope = std::numeric_limits<float>::infinity();  ///< lowest slope of the rays that passed on
  float lip_m = -std::numeric_limits<float>::infinity();         ///< where the nearer ground would have continued
  bool shadowed = false;  ///< ground at the height of the nearer ground is hidden by a return before it
};

/// Rays are straight lines in a vertical plane from one origin, so per azimuth bin a single pass from far to near
/// gives, for every distance, the lowest ray that passed over it (suffix minimum of slopes), and a pass from near to
/// far gives the shadow line (prefix maximum).
class PolarRays {
 public:
  explicit PolarRays(const PolarConfig& config);

  /// Forgets the last sensor position. Cost: the bins it had touched.
  void clear();
  /// Points relative to the sensor's origin, metres, map axes. Parallel arrays.
  void add(std::span<const float> x_m, std::span<const float> y_m, std::span<const float> z_m, Executor& executor);
  /// Turns the returns into sights.
  void look(Executor& executor);

  bool touched(int bin) const { return touched_[static_cast<std::size_t>(bin)] != 0; }
  const RaySight& sight(int bin, int ring) const { return sights_[index(bin, ring)]; }
  int bin_of(float x_m, float y_m) const {
    const int bin = static_cast<int>(diamond_angle(x_m, y_m) * bins_per_unit_);
    return bin < config_.bins ? bin : config_.bins - 1;
  }
  int ring_of(float distance_m) const {
    const float ring = distance_m / config_.cell_m;
    return ring < static_cast<float>(config_.rings - 1) ? static_cast<int>(ring) : config_.rings - 1;
  }
  const PolarConfig& config() const { return config_; }

 private:
  struct Returns {
    float min_slope = std::numeric_limits<float>::infinity();
    float max_slope = -std::numeric_limits<float>::infinity();
    float low_m = std::numeric_limits<float>::infinity();  ///< lowest return; +inf = none
  };
  std::size_t index(int bin, int ring) const {
    return static_cast<std::size_t>(bin) * static_cast<std::size_t>(config_.rings) + static_cast<std::size_t>(ring);
  }
  void look_along(int bin);

  PolarConfig config_;
  float bins_per_unit_;
  std::vector<Returns> returns_;
  std::vector<RaySight> sights_;
  std::vector<std::uint8_t> touched_;
  std::vector<std::int32_t> where_;  ///< per point; -1 = at the origin or not finite
  std::vector<float> slope_;
};

}  // namespace scree::mapping
