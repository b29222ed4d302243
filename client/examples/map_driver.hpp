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
#include <unordered_set>
#include <vector>

#include "client/examples/path_planner.hpp"
#include "client/scree_client.hpp"

namespace scree_example {

struct DriverConfig {
  scree::client::Config map;
  PlanRules plan;
  FollowRules follow;
  Point goal;
  double margin_m = 8.0;          ///< the grid to plan on: the box of start and goal, and this much around
  double farthest_m = 40.0;       ///< a goal farther away than this is headed for, in steps
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

  /// Takes what has arrived, plans again when tiles have come or could have expired, and says what to drive now. Stands
  /// still while the map is not fresh, or has been for less than a cycle of refreshes after it was lost, the pose is
  /// old, the health forbids it, there is no path, or it has arrived.
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
      waiting_since_ = Time();
      return {};
    }
    if (distance_m(posture_.at, config_.goal) <= config_.follow.goal_radius_m) phase_ = Phase::arrived;
    if (done()) return {};
    const std::uint64_t tiles = client_.counters().tiles;
    if (now - planned_at_ > kPlanAgain || (tiles != planned_tiles_ && now - planned_at_ > kPlanApart)) plan(now, tiles);
    if (path_.found)
      waiting_since_ = Time();
    else if (waiting_since_ == Time())
      waiting_since_ = now;
    else if (now - waiting_since_ > std::chrono::duration<double>(config_.patience_s))
      phase_ = Phase::no_path;
    moving_ = path_.found;
    if (!path_.found) return {};
    phase_ = Phase::driving;
    return follow(path_, posture_, config_.follow);
  }

  /// After the map was lost its tiles come back with the refresh: until then unknown ground may be known to be lethal.
  bool map_is_whole(Time now) {
    const bool fresh = client_.fresh(now);
    if (client_.state(now) == scree::client::State::lost || client_.boot_id() != boot_id_) back_since_ = Time();
    boot_id_ = client_.boot_id();
    if (!fresh || client_.announce() == nullptr) return false;
    if (back_since_ == Time()) {
      back_since_ = now;
      path_ = {};
      lethal_.clear();
    }
    return now - back_since_ >= std::chrono::milliseconds(client_.announce()->refresh_ms);
  }

  bool may_drive(Time now) {
    scree::client::Pose pose;
    if (!map_is_whole(now) || !client_.pose(pose, now)) return false;
    if ((client_.health(now) & (config_.stop_on_health | scree::client::kFault)) != 0) return false;
    const std::int64_t age_ns = age_of(pose);
    if (age_ns > static_cast<std::int64_t>(1e9 * config_.max_pose_age_s)) return false;
    const double yaw_rad =
        std::atan2(2.0 * (pose.qw * pose.qz + pose.qx * pose.qy), 1.0 - 2.0 * (pose.qy * pose.qy + pose.qz * pose.qz));
    const std::int64_t now_ns = now.time_since_epoch().count();
    posture_ = history_.carry({{pose.x_m, pose.y_m}, yaw_rad}, now_ns - age_ns, now_ns);
    return true;
  }

  /// Since it was delivered to the node; or, once the node's clock is known, since it held, which is longer.
  std::int64_t age_of(const scree::client::Pose& pose) const {
    const scree::client::ClockOffset& clock = client_.clock_offset();
    if (!clock.known) return pose.age.count();
    const auto unix_now = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(unix_now).count();
    return std::max<std::int64_t>(pose.age.count(), now_ns + clock.offset_ns - pose.t_ns);
  }

  void plan(Time now, std::uint64_t tiles) {
    planned_at_ = now;
    planned_tiles_ = tiles;
    path_ = copy_costs(now) ? planner_.plan(grid_, posture_.at, step_goal()) : Path{};
    ++counters_.plans;
    counters_.plans_without_path += path_.found ? 0U : 1U;
  }

  /// The goal, or the place towards it that is farthest_m away.
  Point step_goal() const {
    const double away_m = distance_m(posture_.at, config_.goal);
    const double share = std::min(1.0, config_.farthest_m / std::max(away_m, 1e-9));
    return {posture_.at.x_m + share * (config_.goal.x_m - posture_.at.x_m),
            posture_.at.y_m + share * (config_.goal.y_m - posture_.at.y_m)};
  }

  /// The map's window in a grid that holds start and goal too; what the window does not hold is unknown, and what it
  /// held as lethal and does not know any more stays lethal.
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
    for (std::size_t i = 0; i < window_.cost.size(); ++i) remember(grid, i);
    cut_to_box(window_, posture_.at, step_goal(), config_.margin_m, grid_);
    return true;
  }

  void remember(const scree::client::Grid& grid, std::size_t i) {
    std::uint8_t& cost = window_.cost[i];
    if (cost != kLethal && lethal_.empty()) return;
    const std::int64_t x = grid.x_min_cells + static_cast<std::int64_t>(i % grid.columns);
    const std::int64_t y = grid.y_min_cells + static_cast<std::int64_t>(i / grid.columns);
    const std::int64_t cell = y * (std::int64_t{1} << 32) + x;
    if (cost == kLethal)
      lethal_.insert(cell);
    else if (cost != kUnknown)
      lethal_.erase(cell);
    else if (lethal_.count(cell) > 0)
      cost = kLethal;
  }

  static constexpr std::chrono::milliseconds kPlanApart{50}, kPlanAgain{200};

  DriverConfig config_;
  scree::client::Client client_;
  PathPlanner planner_;
  CostGrid window_, grid_;
  Path path_;
  Posture posture_;
  DriveHistory history_;
  DriverCounters counters_;
  Phase phase_ = Phase::waiting;
  Time planned_at_, waiting_since_, back_since_;  ///< zero = not yet
  std::uint64_t planned_tiles_ = 0, boot_id_ = 0;
  std::unordered_set<std::int64_t> lethal_;  ///< cells of the lattice that were lethal when last known
  bool moving_ = false;
};

}  // namespace scree_example
