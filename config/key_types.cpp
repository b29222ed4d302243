#include "config/key_types.hpp"

#include <cmath>
#include <fmt/format.h>

namespace scree::config {

std::string Bounds::text(const char* noun) const {
  const bool from = std::isfinite(min);
  const bool to = std::isfinite(max);
  if (from && above_min)
    return to ? fmt::format("{} above {}, at most {}", noun, min, max) : fmt::format("{} above {}", noun, min);
  if (from) return to ? fmt::format("{} from {} to {}", noun, min, max) : fmt::format("{} of at least {}", noun, min);
  return to ? fmt::format("{} of at most {}", noun, max) : std::string(noun);
}

Schema<Pose> pose_schema(bool required) {
  Schema<Pose> schema;
  const Bounds far{-1e7, 1e7, false};
  const Bounds unit{-1.001, 1.001, false};
  const auto add = [&](const char* name, Lens<Pose, double> lens, const Bounds& bounds, const char* doc) {
    schema.keys.push_back(number<Pose>(name, std::move(lens), bounds, doc));
    schema.keys.back().required = required;
  };
  add(
      "x_m", [](Pose& pose) -> double& { return pose.translation_m.x(); }, far, "Translation.");
  add(
      "y_m", [](Pose& pose) -> double& { return pose.translation_m.y(); }, far, "Translation.");
  add(
      "z_m", [](Pose& pose) -> double& { return pose.translation_m.z(); }, far, "Translation.");
  add(
      "qx", [](Pose& pose) -> double& { return pose.rotation.x(); }, unit, "Rotation, unit quaternion.");
  add(
      "qy", [](Pose& pose) -> double& { return pose.rotation.y(); }, unit, "Rotation, unit quaternion.");
  add(
      "qz", [](Pose& pose) -> double& { return pose.rotation.z(); }, unit, "Rotation, unit quaternion.");
  add(
      "qw", [](Pose& pose) -> double& { return pose.rotation.w(); }, unit, "Rotation, unit quaternion.");
  schema.rules.push_back({{"qx", "qy", "qz", "qw"}, [](const Pose& pose) -> std::optional<Contradiction> {
                            const double norm = pose.rotation.norm();
                            if (std::abs(norm - 1.0) <= 1e-3) return std::nullopt;
                            return Contradiction{"qx qy qz qw of norm 1 ± 0.001", fmt::format("norm {:.6g}", norm)};
                          }});
  return schema;
}

}  // namespace scree::config
