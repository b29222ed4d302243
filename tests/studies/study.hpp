#pragma once
// What the studies share: a run of the binary that must succeed, the map that it wrote, sums of deviations.

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
