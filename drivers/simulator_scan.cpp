#include "drivers/simulator_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/random.hpp"

namespace scree::drivers {
namespace {

constexpr int kBeamSide = 3;  // rays across the beam where it may meet an edge
constexpr int kBeamParts = kBeamSide * kBeamSide;
constexpr double kFarthest_m = 1e5;  // a ray that has met nothing by then never will: no terrain is higher
// A range profile that bends by b from pixel to pixel moves the mean over the beam by b/24: below 0.1 % of the range
// the central ray stands for the beam.
constexpr double kBend_ratio = 0.02;
constexpr double kBend_counts = 2.0;
constexpr double kReflectanceScale = 4095.0;

std::array<double, 4> four_normals(std::uint64_t seed, std::uint64_t stream, int x, int y) {
  const auto words = random_words(seed, stream, x, y);
  std::array<double, 4> normals{};
  for (std::size_t i = 0; i < 4; i += 2) {
    const double radius = std::sqrt(-2.0 * std::log(to_uniform(words[i])));
    const double angle = 2.0 * std::numbers::pi * to_uniform(words[i + 1]);
    normals[i] = radius * std::cos(angle);
    normals[i + 1] = radius * std::sin(angle);
  }
  return normals;
}

std::uint16_t reflectance_count(double reflectance) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(reflectance, 0.0, 1.0) * kReflectanceScale));
}

class Scan {
 public:
  Scan(const ScanSetup& setup, const std::vector<Pose>& T_map_sensor, const std::vector<double>& drift_m,
       std::uint64_t sequence)
      : setup_(setup), T_map_sensor_(T_map_sensor), drift_m_(drift_m), sequence_(sequence) {
    result_.raw.assign(setup.rows, setup.columns, 0);
    result_.reflectance.assign(setup.rows, setup.columns, 0);
    result_.true_range_m.assign(setup.rows, setup.columns, std::numeric_limits<float>::quiet_NaN());
    if (setup.noise) centre_.assign(setup.rows, setup.columns, BeamEcho{-1.0, 0.0, 0.0});
  }

  /// Central rays; without noise they are all there is.
  void cast_row(int row) {
    const RowFrame frame(T_map_sensor_[static_cast<std::size_t>(row)]);
    for (int column = 0; column < setup_.columns; ++column) {
      const PixelRay& ray = ray_of(row, column);
      BeamEcho echo;
      if (!meet(frame, ray.origin_m, ray.direction, echo)) continue;
      result_.true_range_m(row, column) = static_cast<float>(echo.range_m);
      if (setup_.noise) {
        centre_(row, column) = echo;
      } else if (echo.range_m <= setup_.physics.max_range_m) {
        result_.raw(row, column) = record_count(ray, echo.range_m, setup_.ambiguity_m > 0.0);
        result_.reflectance(row, column) = reflectance_count(echo.reflectance);
      }
    }
  }

  /// The beam's reading from the echoes that `cast_row` left for all rows.
  void read_row(int row) {
    const RowFrame frame(T_map_sensor_[static_cast<std::size_t>(row)]);
    std::array<BeamEcho, kBeamParts> echoes;
    for (int column = 0; column < setup_.columns; ++column) {
      const BeamEcho& centre = centre_(row, column);
      std::size_t count = 0;
      if (centre.range_m > 0.0) echoes[count++] = centre;
      int parts = 1;
      if (meets_edge(row, column)) {
        parts = kBeamParts;
        spread(frame, row, column, echoes, count);
      }
      if (count == 0) continue;  // met nothing
      const auto reading =
          read_beam(setup_.physics, setup_.ambiguity_m, std::span<const BeamEcho>(echoes.data(), count), parts,
                    four_normals(setup_.seed, sequence_, column, row));
      if (!reading) continue;
      const double range_m = reading->range_m + drift_m_[static_cast<std::size_t>(row)];
      result_.raw(row, column) = record_count(ray_of(row, column), range_m, setup_.ambiguity_m > 0.0);
      result_.reflectance(row, column) = reflectance_count(reading->reflectance);
    }
  }

  ScanResult take() { return std::move(result_); }

 private:
  /// A row's pose as matrix and vector: cheaper than the quaternion for each ray.
  struct RowFrame {
    explicit RowFrame(const Pose& T_map_sensor)
        : rotation(T_map_sensor.rotation.toRotationMatrix()), translation_m(T_map_sensor.translation_m) {}
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation_m;
  };

  const PixelRay& ray_of(int row, int column) const {
    return setup_.rays[static_cast<std::size_t>(row) * static_cast<std::size_t>(setup_.columns) +
                       static_cast<std::size_t>(column)];
  }

  bool meet(const RowFrame& frame, const Eigen::Vector3d& origin_sensor_m, const Eigen::Vector3d& direction_sensor,
            BeamEcho& echo) const {
    const Eigen::Vector3d origin = frame.rotation * origin_sensor_m + frame.translation_m;
    const Eigen::Vector3d direction = frame.rotation * direction_sensor;
    const TerrainHit hit = setup_.terrain.cast(origin, direction, kFarthest_m);
    if (hit.kind != TerrainHit::Kind::surface) return false;
    const Eigen::Vector3d place = origin + hit.distance_m * direction;
    echo.range_m = hit.distance_m;
    echo.cos_incidence = std::abs(hit.normal.dot(direction));
    echo.reflectance = ground_reflectance(setup_.physics, setup_.seed, place.x(), place.y());
    return true;
  }

  /// The outer rays of the beam; their directions are the neighbours' apart.
  void spread(const RowFrame& frame, int row, int column, std::array<BeamEcho, kBeamParts>& echoes,
              std::size_t& count) const {
    const PixelRay& ray = ray_of(row, column);
    const int left = std::max(column - 1, 0), right = std::min(column + 1, setup_.columns - 1);
    const int above = std::max(row - 1, 0), below = std::min(row + 1, setup_.rows - 1);
    const double width = setup_.physics.beam_pitches / kBeamSide;
    const Eigen::Vector3d across =
        (ray_of(row, right).direction - ray_of(row, left).direction) * (width / std::max(right - left, 1));
    const Eigen::Vector3d along =
        (ray_of(below, column).direction - ray_of(above, column).direction) * (width / std::max(below - above, 1));
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        if (i == 0 && j == 0) continue;
        const Eigen::Vector3d direction = (ray.direction + i * across + j * along).normalized();
        if (meet(frame, ray.origin_m, direction, echoes[count])) ++count;
      }
  }

  /// Whether the ranges around the pixel are not those of one smooth surface. Inverse ranges of a plane are as good as
  /// linear over the image however grazing the rays; their second difference times range² is the bend in range.
  bool meets_edge(int row, int column) const {
    const double here = centre_(row, column).range_m;
    const double limit = std::max(kBend_counts * ray_of(row, column).range_per_count_m, kBend_ratio * here);
    const auto bends = [&](int row_step, int column_step) {
      const int r0 = row - row_step, r1 = row + row_step, c0 = column - column_step, c1 = column + column_step;
      if (!centre_.contains(r0, c0) || !centre_.contains(r1, c1)) return false;
      const double before = centre_(r0, c0).range_m, after = centre_(r1, c1).range_m;
      if (here < 0.0 && before < 0.0 && after < 0.0) return false;
      if (here < 0.0 || before < 0.0 || after < 0.0) return true;
      return std::abs(here * here * (1.0 / before + 1.0 / after) - 2.0 * here) > limit;
    };
    return bends(0, 1) || bends(1, 0) || bends(1, 1) || bends(1, -1);
  }

  const ScanSetup& setup_;
  const std::vector<Pose>& T_map_sensor_;
  const std::vector<double>& drift_m_;
  std::uint64_t sequence_;
  ScanResult result_;
  Grid<BeamEcho> centre_;  ///< range −1: met nothing
};

}  // namespace

std::uint16_t record_count(const PixelRay& ray, double range_m, bool wraps) {
  const double count = count_at_range(ray, range_m);
  if (wraps) {
    const std::uint16_t wrapped = wrapped_count(count);
    if (wrapped != 0) return wrapped;
    return static_cast<std::uint16_t>(count < std::round(count) ? kPerceptronCounts - 1 : 1);
  }
  const double nearest = std::round(count);
  if (!(nearest <= std::numeric_limits<std::uint16_t>::max())) return 0;
  return static_cast<std::uint16_t>(std::max(nearest, 1.0));
}

ScanResult scan(const ScanSetup& setup, const std::vector<Pose>& T_map_sensor, const std::vector<double>& drift_m,
                std::uint64_t sequence, Executor& executor) {
  Scan scan(setup, T_map_sensor, drift_m, sequence);
  executor.for_ranges(setup.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) scan.cast_row(row);
  });
  if (setup.noise)
    executor.for_ranges(setup.rows, [&](int begin, int end) {
      for (int row = begin; row < end; ++row) scan.read_row(row);
    });
  return scan.take();
}

}  // namespace scree::drivers
