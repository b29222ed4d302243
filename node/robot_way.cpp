#include "node/robot_way.hpp"

#include <algorithm>
#include <utility>

namespace scree::node {
namespace {

class TrajectoryWay final : public RobotWay {
 public:
  explicit TrajectoryWay(const drivers::Simulator& simulator) : simulator_(simulator) {}

  void advance_to(Time time) override { now_ = time; }
  const std::vector<StampedPose>& truth() const override { return simulator_.poses().poses(); }
  const std::vector<StampedPose>& odometry() const override { return simulator_.odometry().poses(); }
  bool can_render(std::size_t i) const override { return simulator_.last_row_time(i) <= now_; }
  Result<drivers::SimulatedFrame> render(std::size_t i, Executor& executor) const override {
    return simulator_.render(i, executor);
  }
  std::optional<std::size_t> frame_count() const override { return simulator_.frame_count(); }

 private:
  const drivers::Simulator& simulator_;
  Time now_ = simulator_.frame_time(0);
};

class DrivenWay final : public RobotWay {
 public:
  DrivenWay(const drivers::Simulator& simulator, drivers::DrivenRobot& robot) : simulator_(simulator), robot_(robot) {}

  void advance_to(Time time) override { robot_.advance_to(time); }
  const std::vector<StampedPose>& truth() const override { return robot_.truth(); }
  const std::vector<StampedPose>& odometry() const override { return robot_.odometry(); }
  bool can_render(std::size_t i) const override { return simulator_.last_row_time(i) <= robot_.truth().back().time; }
  Result<drivers::SimulatedFrame> render(std::size_t i, Executor& executor) const override {
    auto track = PoseTrack::make(poses_around(robot_.truth(), simulator_.frame_time(i), simulator_.last_row_time(i)));
    if (!track) return track.error();
    return simulator_.render_along(*track, i, executor);
  }
  std::optional<std::size_t> frame_count() const override { return std::nullopt; }

 private:
  const drivers::Simulator& simulator_;
  drivers::DrivenRobot& robot_;
};

}  // namespace

std::unique_ptr<RobotWay> along_trajectory(const drivers::Simulator& simulator) {
  return std::make_unique<TrajectoryWay>(simulator);
}

std::unique_ptr<RobotWay> as_driven(const drivers::Simulator& simulator, drivers::DrivenRobot& robot) {
  return std::make_unique<DrivenWay>(simulator, robot);
}

std::vector<StampedPose> poses_around(const std::vector<StampedPose>& track, Time begin, Time end) {
  const auto later = [](Time time, const StampedPose& pose) { return time < pose.time; };
  const auto earlier = [](const StampedPose& pose, Time time) { return pose.time < time; };
  auto first = std::upper_bound(track.begin(), track.end(), begin, later);
  if (first != track.begin()) --first;
  auto last = std::lower_bound(first, track.end(), end, earlier);
  if (last != track.end()) ++last;
  return {first, last};
}

}  // namespace scree::node
