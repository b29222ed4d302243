#include "node/plan_report.hpp"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/picture.hpp"

namespace scree::node {

std::string plan_json(const Drive& drive, const scree_example::MapDriver& driver,
                      const scree_example::DriveSender& wheels, const scree_example::Point& goal) {
  const auto& counters = driver.counters();
  nlohmann::ordered_json json{{"ended", drive.ended},
                              {"duration_s", drive.duration_s},
                              {"path_m", drive.path_m},
                              {"distance_to_goal_m", scree_example::distance_m(driver.posture().at, goal)},
                              {"plans", counters.plans},
                              {"plans_without_path", counters.plans_without_path},
                              {"stops_not_fresh", counters.stops_not_fresh},
                              {"commands_sent", wheels.sent()},
                              {"commands_failed", wheels.failed()}};
  auto& received = json["received"] = nlohmann::ordered_json::object();
  driver.map().counters().for_each([&](const char* name, std::uint64_t value) { received[name] = value; });
  return json.dump(2) + '\n';
}

Status write_track(const std::string& file, const Drive& drive) {
  std::ofstream stream(file, std::ios::binary);
  stream << "t_s,x_m,y_m,heading_rad\n";
  for (const TrackPoint& p : drive.track)
    stream << fmt::format("{:.3f},{:.4f},{:.4f},{:.5f}\n", p.t_s, p.x_m, p.y_m, p.heading_rad);
  stream.close();
  if (stream) return {};
  return Error{ErrorKind::cannot_create, fmt::format("{}: expected a file that can be written, found none", file)};
}

Status write_plan_picture(const std::string& file, const Drive& drive, const scree_example::MapDriver& driver,
                          const drivers::Terrain* terrain) {
  const auto& grid = driver.grid();
  if (grid.cost.empty()) return Error{ErrorKind::bad_data, file + ": expected a map to draw, found none received"};
  Grid<float> cost(grid.rows, grid.columns), height_m(grid.rows, grid.columns, std::nanf(""));
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = grid.index(column, row);
      cost(row, column) = grid.cost[i] == scree_example::kUnknown ? std::nanf("") : static_cast<float>(grid.cost[i]);
      const auto at = grid.centre(i);
      if (terrain != nullptr) height_m(row, column) = static_cast<float>(terrain->height_m(at.x_m, at.y_m));
    }
  std::vector<io::PicturePanel> panels;
  if (terrain != nullptr)
    panels.push_back({"true terrain / m", height_m, {io::ColourMap::terrain, std::nullopt, std::nullopt, true}});
  panels.push_back({"cost at the last plan (0 free, 254 lethal)", cost, {io::ColourMap::cost, 0.0, 254.0, false}});
  io::PicturePath way;
  for (const TrackPoint& p : drive.track) way.points_m.push_back({p.x_m, p.y_m});
  return io::write_map_picture(file, panels, {grid.x_min_m, grid.y_min_m, grid.cell_m}, std::nullopt,
                               fmt::format("{} after {:.1f} s, {:.1f} m", drive.ended, drive.duration_s, drive.path_m),
                               {way});
}

}  // namespace scree::node
