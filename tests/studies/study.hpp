#pragma once
// What the studies share: a run of the binary that must succeed, the map that it wrote, sums of deviations.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/cell_state.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "io/npy.hpp"
#include "tests/support/process.hpp"

namespace scree::study {

namespace fs = std::filesystem;

[[noreturn]] inline void fail(const std::string& message) {
  std::fprintf(stderr, "study: %s\n", message.c_str());
  std::exit(1);
}

template <class T>
T must(Result<T> result) {
  if (!result) fail(result.error().message);
  return *std::move(result);
}

/// stdout of a command that must end with 0.
inline std::string must_run(std::vector<std::string> command) {
  const std::string name = command.size() > 1 ? command[1] : command[0];
  const test::Finished finished = test::run(std::move(command), std::chrono::minutes(8));
  if (finished.exit_code != 0) fail(name + " ended with " + std::to_string(finished.exit_code) + "\n" + finished.err);
  return finished.out;
}

struct Map {
  Grid<float> elevation_m, state;
  double cell_m = 0.0, x_min_m = 0.0, y_min_m = 0.0;
  bool measured(int row, int column) const { return state(row, column) == static_cast<float>(CellState::measured); }
};

/// The layers that `--map-out BASE.npy` wrote.
inline Map read_map(const fs::path& base) {
  const auto layer = [&](const char* name) { return must(io::read_npy(base.string() + "." + name + ".npy")); };
  Map map{layer("elevation"), layer("cell_state")};
  const auto json = nlohmann::json::parse(std::ifstream(base.string() + ".json"));
  map.cell_m = json.at("cell_m");
  map.x_min_m = json.at("x_min_m");
  map.y_min_m = json.at("y_min_m");
  return map;
}

/// Replays a recording alone and keeps its layers as BASE.*.npy and the picture as BASE.png; the node's statistics.
inline nlohmann::json replay_map(const std::string& scree, const fs::path& recording, const fs::path& base,
                                 const std::vector<std::string>& settings, std::vector<std::string> more = {}) {
  std::vector<std::string> command{scree,    "replay",    recording.string(),     "--rate",     "max",
                                   "--json", "--map-out", base.string() + ".npy", "--snapshot", base.string() + ".png"};
  for (const char* setting : {"publish.destination=127.0.0.1:9", "publish.listen=127.0.0.1:0"})
    command.insert(command.end(), {"--set", setting});
  for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
  command.insert(command.end(), more.begin(), more.end());
  return nlohmann::json::parse(must_run(command));
}

/// Nothing measured is in the way of a vehicle of the default size: around the cell 30 % are measured within reach of
/// its wheels, and all of these lie within 5 cm of one plane that is no steeper than 0.3. What such ground costs is
/// what the map itself adds to it.
inline bool is_plain(const Map& map, int row, int column) {
  constexpr double kReach_m = 0.62, kLeastShare = 0.3, kAside_m = 0.05, kSteepest = 0.3;
  const int reach = static_cast<int>(kReach_m / map.cell_m + 0.5);
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  std::vector<std::pair<Eigen::Vector3d, double>> points;
  int cells = 0;
  for (int dr = -reach; dr <= reach; ++dr)
    for (int dc = -reach; dc <= reach; ++dc) {
      if (dr * dr + dc * dc > reach * reach) continue;
      ++cells;
      if (!map.state.contains(row + dr, column + dc) || !map.measured(row + dr, column + dc)) continue;
      const Eigen::Vector3d place(dc * map.cell_m, dr * map.cell_m, 1.0);
      points.emplace_back(place, map.elevation_m(row + dr, column + dc));
      products += place * place.transpose();
      sums += place * points.back().second;
    }
  if (points.size() < 6 || static_cast<double>(points.size()) < kLeastShare * cells) return false;
  const Eigen::Vector3d plane = products.ldlt().solve(sums);
  if (!(plane.head<2>().norm() <= kSteepest)) return false;
  return std::all_of(points.begin(), points.end(),
                     [&](const auto& point) { return std::abs(plane.dot(point.first) - point.second) < kAside_m; });
}

inline void print_cost_heading() {
  std::puts("| measured cells of | n | cost < 64, % | 64 … 253, % | lethal, % |\n|---|---|---|---|---|");
}

/// What the measured cells of a written map cost, of those that `chosen(row, column)` takes.
template <class Chosen>
void print_cost_row(const std::string& name, const fs::path& base, const Map& map, const Chosen& chosen) {
  const auto cost = must(io::read_npy(base.string() + ".cost.npy"));
  std::size_t n = 0, low = 0, lethal = 0;
  for (int row = 0; row < cost.rows(); ++row)
    for (int column = 0; column < cost.columns(); ++column) {
      if (!map.measured(row, column) || !chosen(row, column)) continue;
      ++n;
      low += cost(row, column) < 64.0F ? 1U : 0U;
      lethal += cost(row, column) == 254.0F ? 1U : 0U;
    }
  const auto share = [n](std::size_t k) { return 100.0 * static_cast<double>(k) / static_cast<double>(n); };
  std::printf("| %s | %zu | %.1f | %.1f | %.1f |\n", name.c_str(), n, share(low), share(n - low - lethal),
              share(lethal));
}

inline void print_costs(const std::string& name, const fs::path& base) {
  const Map map = read_map(base);
  print_cost_row(name, base, map, [](int, int) { return true; });
  print_cost_row(name + ", plain ground", base, map, [&](int row, int column) { return is_plain(map, row, column); });
}

/// Signed errors; every figure of none of them is NaN.
struct Deviation {
  std::vector<double> errors;
  void add(double error) { errors.push_back(error); }
  std::size_t n() const { return errors.size(); }
  double bias() const {
    double sum = 0.0;
    for (const double e : errors) sum += e;
    return sum / static_cast<double>(n());
  }
  double rmse() const {
    double sum = 0.0;
    for (const double e : errors) sum += e * e;
    return std::sqrt(sum / static_cast<double>(n()));
  }
  /// The size that a share q of the errors stays within.
  double within(double q) const {
    if (errors.empty()) return std::nan("");
    std::vector<double> sizes;
    for (const double e : errors) sizes.push_back(std::abs(e));
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(sizes.size() - 1) + 0.5);
    std::nth_element(sizes.begin(), at, sizes.end());
    return *at;
  }
  std::size_t beyond(double limit) const {
    return static_cast<std::size_t>(
        std::count_if(errors.begin(), errors.end(), [limit](double e) { return std::abs(e) > limit; }));
  }
};

}  // namespace scree::study
