// Lines, arcs and files of places.

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <numbers>

#include "drivers/driven_robot.hpp"
#include "drivers/simulator_grammar.hpp"
#include "drivers/table.hpp"
#include "drivers/trajectory.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kMostPoses = 2e6;  // five and a half hours at 10 ms

Error wrong(std::string_view specification, std::string_view reason) {
  return grammar_error(kTrajectoryGrammar, specification, reason);
}

/// Signed way length and curvature make lines and arcs one thing.
struct Curve {
  double x_m, y_m, heading_rad, length_m, curvature_per_m, speed_mps;

  PlanarPose at(double way_m) const { return along_arc({Time{}, x_m, y_m, heading_rad}, way_m, curvature_per_m); }
};

Result<std::vector<PlanarPose>> sample(const Curve& curve, std::string_view specification, Duration period) {
  if (!(curve.speed_mps > 0.0)) return wrong(specification, "SPEED_MPS must be positive");
  const double seconds = curve.length_m / curve.speed_mps;
  const double steps = std::ceil(seconds / to_seconds(period));
  if (!(steps <= kMostPoses)) return wrong(specification, fmt::format("a drive of {:.3g} s is too long", seconds));
  std::vector<PlanarPose> way;
  const auto count = static_cast<std::int64_t>(steps);
  way.reserve(static_cast<std::size_t>(count) + 1);
  for (std::int64_t i = 0; i <= count; ++i) {
    const Duration t = i < count ? i * period : from_seconds(seconds);
    if (!way.empty() && Time(t) <= way.back().time) break;  // the last step was shorter than a nanosecond
    PlanarPose pose = curve.at(i < count ? to_seconds(t) * curve.speed_mps : curve.length_m);
    pose.time = Time(t);
    way.push_back(pose);
  }
  return way;
}

Result<std::vector<PlanarPose>> line(std::string_view specification, Duration period) {
  const auto n = parse_numbers(specification.substr(5), 5, 5, kTrajectoryGrammar);
  if (!n) return n.error();
  if ((*n)[3] < 0.0) return wrong(specification, "LENGTH_M must not be negative");
  return sample({(*n)[0], (*n)[1], (*n)[2] * kDegree_rad, (*n)[3], 0.0, (*n)[4]}, specification, period);
}

Result<std::vector<PlanarPose>> arc(std::string_view specification, Duration period) {
  const auto n = parse_numbers(specification.substr(4), 6, 6, kTrajectoryGrammar);
  if (!n) return n.error();
  const double radius_m = (*n)[3], angle_rad = (*n)[4] * kDegree_rad;
  if (!(radius_m > 0.0)) return wrong(specification, "RADIUS_M must be positive");
  const double curvature = (angle_rad < 0.0 ? -1.0 : 1.0) / radius_m;
  return sample({(*n)[0], (*n)[1], (*n)[2] * kDegree_rad, std::abs(angle_rad) * radius_m, curvature, (*n)[5]},
                specification, period);
}

Result<std::vector<PlanarPose>> parse_places(std::string_view text, const std::string& name) {
  std::vector<PlanarPose> places;
  const auto status = parse_table(text, name, kPlanarHeader, [&](std::size_t number, auto fields) -> Status {
    const auto bad = [&](const std::string& expected, const std::string& found) {
      return Error{ErrorKind::bad_data, fmt::format("{}:{}: expected {}, found {}", name, number, expected, found)};
    };
    if (fields.size() != 4) return bad("4 fields", fmt::format("{}", fields.size()));
    const auto t = parse_seconds(fields[0]);
    if (!t) return bad("t_s in seconds", fmt::format("'{}'", fields[0]));
    double values[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = parse_number(fields[i + 1]);
      if (!value) return bad("a finite number", fmt::format("'{}'", fields[i + 1]));
      values[i] = *value;
    }
    if (!places.empty() && Time(*t) <= places.back().time)
      return bad("a time after the line before", fmt::format("{} s", fields[0]));
    places.push_back({Time(*t), values[0], values[1], values[2] * kDegree_rad});
    return {};
  });
  if (!status) return status.error();
  if (places.empty())
    return Error{ErrorKind::bad_data, fmt::format("{}: expected at least one place, found none", name)};
  return places;
}

/// Straight between places, the short way round in heading, at least as dense as `period`.
Result<std::vector<PlanarPose>> densify(const std::vector<PlanarPose>& places, const std::string& name,
                                        Duration period) {
  if (to_seconds(places.back().time - places.front().time) / to_seconds(period) > kMostPoses)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected a drive of at most {:.0f} s, found {:.0f} s", name,
                             kMostPoses * to_seconds(period), to_seconds(places.back().time - places.front().time))};
  std::vector<PlanarPose> way;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const PlanarPose &a = places[i], &b = places[i + 1];
    const Duration gap = b.time - a.time;
    const auto parts = (gap.count() + period.count() - 1) / period.count();
    const double turn = std::remainder(b.heading_rad - a.heading_rad, 2.0 * std::numbers::pi);
    for (std::int64_t part = 0; part < parts; ++part) {
      const double weight = static_cast<double>(part) / static_cast<double>(parts);
      way.push_back({a.time + gap * part / parts, a.x_m + weight * (b.x_m - a.x_m), a.y_m + weight * (b.y_m - a.y_m),
                     a.heading_rad + weight * turn});
    }
  }
  way.push_back(places.back());
  return way;
}

}  // namespace

Result<std::vector<PlanarPose>> planar_way(std::string_view specification, Duration pose_period) {
  if (specification.starts_with("line:")) return line(specification, pose_period);
  if (specification.starts_with("arc:")) return arc(specification, pose_period);
  const std::filesystem::path file(specification);
  if (file.extension() != ".csv") return wrong(specification, "neither line:, arc: nor a .csv file");
  std::vector<std::uint8_t> bytes;
  if (auto status = io::read_bytes(file, kTableMaxBytes, bytes); !status) return status.error();
  const auto text = io::as_text(bytes);
  if (text.starts_with(kPosesHeader)) return std::vector<PlanarPose>{};
  const auto places = parse_places(text, file.string());
  if (!places) return places.error();
  return densify(*places, file.string(), pose_period);
}

}  // namespace scree::drivers
