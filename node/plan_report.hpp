#pragma once
// What a drive of the example planner came to: as JSON, as a table of places, as a picture.

#include <cmath>
#include <string>
#include <vector>

#include "client/examples/drive_command.hpp"
#include "client/examples/map_driver.hpp"
#include "core/result.hpp"
#include "drivers/terrain.hpp"

namespace scree::node {

struct TrackPoint {
  double t_s, x_m, y_m, heading_rad;
};

/// What the planner did, and when it ended.
struct Drive {
  std::vector<TrackPoint> track;  ///< where the map said that the robot was, whenever it had moved by 2 cm
  double path_m = 0.0, duration_s = 0.0;
  std::string ended = "timeout";

  void note(double t_s, const scree_example::Posture& posture) {
    if (!track.empty()) {
      const TrackPoint& last = track.back();
      const double moved_m = std::hypot(posture.at.x_m - last.x_m, posture.at.y_m - last.y_m);
      if (moved_m < 0.02) return;
      path_m += moved_m;
    }
    track.push_back({t_s, posture.at.x_m, posture.at.y_m, posture.heading_rad});
  }
};

/// Counters of planner, wheels and client with what the drive was. `goal` in metres of the map.
std::string plan_json(const Drive& drive, const scree_example::MapDriver& driver,
                      const scree_example::DriveSender& wheels, const scree_example::Point& goal);

/// CSV: t_s,x_m,y_m,heading_rad. Errors: cannot_create.
Status write_track(const std::string& file, const Drive& drive);

/// The way over the costs that the last plan saw and, where there is one, the true terrain. Errors: bad_data (no map
/// was received), cannot_create, unavailable.
Status write_plan_picture(const std::string& file, const Drive& drive, const scree_example::MapDriver& driver,
                          const drivers::Terrain* terrain);

}  // namespace scree::node
