#include "drivers/odometry.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/random.hpp"

namespace scree::drivers {
namespace {

constexpr std::uint64_t kBiasStream = 0x6f646f6d62696173;
constexpr std::uint64_t kWalkStream = 0x6f646f6d77616c6b;
constexpr std::uint64_t kAttitudeStream = 0x6f646f6d61747469;

constexpr double kStep_m = 0.25;    // of way, between two values of the walk
constexpr double kMemory_m = 5.0;   // of way, over which the walk forgets
constexpr double kSpacing_s = 0.1;  // between poses
constexpr int kSines = 4;
constexpr double kShortest_s = 8.0, kLongest_s = 40.0;

double normal(std::uint64_t seed, std::uint64_t stream, std::int32_t i, std::int32_t axis) {
  return random_normals(seed, stream, i, axis)[0];
}

/// Error per metre of way along, across and up, as a function of the way that only grows.
class DriftRate {
 public:
  DriftRate(double share, std::uint64_t seed) : share_(share * std::numbers::sqrt2 / 2.0), seed_(seed) {
    for (int axis = 0; axis < 3; ++axis) {
      bias_[axis] = normal(seed, kBiasStream, 0, axis);
      before_[axis] = normal(seed, kWalkStream, 0, axis);
      after_[axis] = stepped(before_[axis], 1, axis);
    }
  }

  Eigen::Vector3d at(double way_m) {
    for (; way_m >= (step_ + 1) * kStep_m; ++step_)
      for (int axis = 0; axis < 3; ++axis)
        before_[axis] = std::exchange(after_[axis], stepped(after_[axis], step_ + 2, axis));
    return share_ * (bias_ + before_ + (way_m / kStep_m - step_) * (after_ - before_));
  }

 private:
  double stepped(double value, std::int32_t step, int axis) const {
    const double kept = std::exp(-kStep_m / kMemory_m);
    return kept * value + std::sqrt(1.0 - kept * kept) * normal(seed_, kWalkStream, step, axis);
  }

  double share_;
  std::uint64_t seed_;
  std::int32_t step_ = 0;
  Eigen::Vector3d bias_, before_, after_;
};

/// Rotation vector in map axes.
Eigen::Vector3d attitude_error(double time_s, double rms_rad, std::uint64_t seed) {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < kSines; ++k) {
      const auto words = random_words(seed, kAttitudeStream, k, axis);
      const double octave = (k + to_uniform(words[0])) / kSines;
      const double period_s = kShortest_s * std::pow(kLongest_s / kShortest_s, octave);
      const double phase = 2.0 * std::numbers::pi * (to_uniform(words[1]) + time_s / period_s);
      error[axis] += std::sqrt(2.0 / kSines) * rms_rad * std::sin(phase);
    }
  return error;
}

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector_rad / angle));
}

Eigen::Quaterniond heading_of(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d forward = rotation * Eigen::Vector3d::UnitX();
  return Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
}

/// The times of `truth`, and times between those that are farther apart than kSpacing_s.
std::vector<Time> dense_times(const PoseTrack& truth) {
  std::vector<Time> times;
  for (const StampedPose& pose : truth.poses()) {
    if (!times.empty()) {
      const Time before = times.back();
      const double gap_s = to_seconds(pose.time - before);
      const auto parts = static_cast<std::int64_t>(std::ceil(gap_s / kSpacing_s));
      for (std::int64_t part = 1; part < parts; ++part) times.push_back(before + part * (pose.time - before) / parts);
    }
    times.push_back(pose.time);
  }
  return times;
}

}  // namespace

struct Odometry::State {
  State(const OdometryErrors& the_errors, std::uint64_t the_seed)
      : errors(the_errors), seed(the_seed), rate(the_errors.drift_share, the_seed) {}
  OdometryErrors errors;
  std::uint64_t seed;
  DriftRate rate;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  double way_m = 0.0;
  std::optional<StampedPose> first;
  Pose before;
};

Odometry::Odometry(const OdometryErrors& errors, std::uint64_t seed) : state_(std::make_unique<State>(errors, seed)) {}
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;
Odometry::~Odometry() = default;

Pose Odometry::advance(Time time, const Pose& truth) {
  State& s = *state_;
  if (!s.errors.any()) return truth;
  if (!s.first) {
    s.first = StampedPose{time, truth};
    s.before = truth;
  }
  const double moved_m = (truth.translation_m - s.before.translation_m).norm();
  s.offset_m += moved_m * (heading_of(truth.rotation) * s.rate.at(s.way_m + 0.5 * moved_m));
  s.way_m += moved_m;
  s.before = truth;
  const Eigen::Vector3d tilt = attitude_error(to_seconds(time - s.first->time), s.errors.attitude_rms_rad, s.seed);
  return {truth.translation_m + s.offset_m, (rotation_by(tilt) * truth.rotation).normalized()};
}

PoseTrack odometry_track(const PoseTrack& truth, const OdometryErrors& errors, std::uint64_t seed) {
  if (!errors.any()) return truth;
  Odometry odometry(errors, seed);
  std::vector<StampedPose> poses;
  Pose before = truth.poses().front().T_map_body;
  for (const Time time : dense_times(truth)) {
    before = truth.at(time).value_or(before);  // inside a gap: nothing is known to move
    poses.push_back({time, odometry.advance(time, before)});
  }
  auto track = PoseTrack::make(std::move(poses));
  return track ? *std::move(track) : truth;  // finite, of unit norm, in the order of its times: make() has no reason
}

}  // namespace scree::drivers
