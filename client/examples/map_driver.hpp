#pragma once
// The loop between the map and the wheels: receives the map, plans, follows, and says what to drive. C++17 and the two
// headers beside it, to be copied. MIT licence, as the rest of Scree.
//
//   MapDriver driver;
//   if (!driver.open(config)) return fail(driver.error());
//   while (!driver.done()) {
//     driver.wait();                       // some milliseconds
//     send_to_wheels(driver.step());       // always: a stop is a command too
//   }

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "client/examples/path_planner.hpp"
#include "client/scree_client.hpp"

namespace scree_example {

struct DriverConfig {
  scree::client::Config map;
  PlanRules plan;
  FollowRules follow;
  Point goal;
  double margin_m = 8.0;          ///< the grid to plan on: the box of start and goal, and this much around
  double patience_s = 10.0;       ///< without a path for so long it gives up
  double max_pose_age_s = 0.5;    ///< with an older pose it stands still
  std::uint16_t stop_on_health =  ///< besides FAULT, which always stops
      scree::client::kPoseStale | scree::client::kSensorLost;
};

enum class Phase : std::uint8_t { waiting, driving, arrived, no_path };

struct DriverCounters {
  std::uint64_t plans = 0, plans_without_path = 0;
  std::uint64_t stops_not_fresh = 0;  ///< times that it stood still because map, pose or health did not allow to drive
};

/// What the vehicle was told, to carry a pose that is some age old to the present.
class DriveHistory {
 public:
  void add(std::int64_t now_ns, const Drive& drive) {
    told_.push_back({now_ns, drive});
    while (told_.size() > 2 && told_[1].at_ns < now_ns - kKeep_ns) told_.pop_front();
  }
  /// Where the vehicle is at `now_ns` that was at `posture` at `then_ns`, if it did as it was told.
  Posture carry(Posture posture, std::int64_t then_ns, std::int64_t now_ns) const {
    for (std::size_t i = 0; i < told_.size(); ++i) {
      const std::int64_t from = std::max(told_[i].at_ns, then_ns);
      const std::int64_t to = i + 1 < told_.size() ? std::min(told_[i + 1].at_ns, now_ns) : now_ns;
      if (to <= from) continue;
      const double way_m = told_[i].drive.speed_mps * 1e-9 * static_cast<double>(to - from);
      const double turn_rad = way_m * told_[i].drive.curvature_per_m;
      posture.heading_rad += 0.5 * turn_rad;
      posture.at.x_m += way_m * std::cos(posture.heading_rad);
      posture.at.y_m += way_m * std::sin(posture.heading_rad);
      posture.heading_rad += 0.5 * turn_rad;
    }
    return posture;
  }

 private:
  static constexpr std::int64_t kKeep_ns = 3'000'000'000;
  struct Told {
    std::int64_t at_ns;
    Drive drive;
  };
  std::deque<Told> told_;
};

class MapDriver {
 public:
  using Time = scree::client::Time;

  bool open(const DriverConfig& config) {
    config_ = config;
    planner_ = PathPlanner(config.plan);
    return client_.open(config.map);
  }
  const char* error() const { return client_.error(); }
  void wait() const { client_.wait(std::chrono::milliseconds(20)); }

  /// Takes what has arrived, plans again when the map has changed, and says what to drive now. Stands still while the
  /// map is not fresh, the pose is old, the health forbids it, there is no path, or it has arrived.
  Drive step(Time now = scree::client::Clock::now()) {
    client_.poll(now);
    const Drive drive = decide(now);
    history_.add(now.time_since_epoch().count(), drive);
    return drive;
  }

  bool done() const { return phase_ == Phase::arrived || phase_ == Phase::no_path; }
  Phase phase() const { return phase_; }
  const Path& path() const { return path_; }
  const Posture& posture() const { return posture_; }
  const CostGrid& grid() const { return grid_; }
  const DriverCounters& counters() const { return counters_; }
  const scree::client::Client& map() const { return client_; }

 private:
  Drive decide(Time now) {
    if (!may_drive(now)) {
      counters_.stops_not_fresh += moving_ ? 1U : 0U;
      moving_ = false;
      return {};
    }
    if (distance_m(posture_.at, config_.goal) <= config_.follow.goal_radius_m) phase_ = Phase::arrived;
    if (done()) return {};
    if (client_.map_rev() != planned_rev_) plan(now);
    if (!path_.found && now - last_path_ > std::chrono::duration<double>(config_.patience_s)) phase_ = Phase::no_path;
    if (!path_.found || done()) return {};
    phase_ = Phase::driving;
    moving_ = true;
    return follow(path_, posture_, config_.follow);
  }

  bool may_drive(Time now) {
    scree::client::Pose pose;
    if (!client_.fresh(now) || !client_.pose(pose, now)) return false;
    if ((client_.health(now) & (config_.stop_on_health | scree::client::kFault)) != 0) return false;
    if (pose.age > std::chrono::duration<double>(config_.max_pose_age_s)) return false;
    const double yaw_rad =
        std::atan2(2.0 * (pose.qw * pose.qz + pose.qx * pose.qy), 1.0 - 2.0 * (pose.qy * pose.qy + pose.qz * pose.qz));
    const std::int64_t now_ns = now.time_since_epoch().count();
    posture_ = history_.carry({{pose.x_m, pose.y_m}, yaw_rad}, now_ns - pose.age.count(), now_ns);
    return true;
  }

  void plan(Time now) {
    if (!copy_costs(now)) return;
    planned_rev_ = client_.map_rev();
    path_ = planner_.plan(grid_, posture_.at, config_.goal);
    ++counters_.plans;
    counters_.plans_without_path += path_.found ? 0U : 1U;
    if (path_.found || last_path_ == Time()) last_path_ = now;
  }

  bool copy_costs(Time now) {
    const scree::client::Grid grid = client_.grid();
    if (grid.columns == 0) return false;
    window_.columns = static_cast<int>(grid.columns);
    window_.rows = static_cast<int>(grid.rows);
    window_.cell_m = grid.resolution_m;
    window_.x_min_m = grid.x_min_m;
    window_.y_min_m = grid.y_min_m;
    window_.cost.resize(grid.cells());
    if (!client_.copy_cost(window_.cost.data(), window_.cost.size(), now)) return false;
    cut_to_box(window_, posture_.at, config_.goal, config_.margin_m, grid_);
    return true;
  }

  DriverConfig config_;
  scree::client::Client client_;
  PathPlanner planner_;
  CostGrid window_, grid_;
  Path path_;
  Posture posture_;
  DriveHistory history_;
  DriverCounters counters_;
  Phase phase_ = Phase::waiting;
  std::uint32_t planned_rev_ = 0;
  Time last_path_;  ///< when there last was one; the first plan starts the clock
  bool moving_ = false;
};

}  // namespace scree_example
