// The whole chain on a real survey: simulate a drive over it, replay the recording through the node, receive the map
// by UDP, and hold the received map against the surface that was scanned and against the survey itself.
// Prints the rows of the table in docs/accuracy.md.  Usage: survey_study SCREE SURVEY.bin

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/cell_state.hpp"
#include "core/grid.hpp"
#include "io/npy.hpp"
#include "io/point_cloud.hpp"
#include "io/raster.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace scree;
namespace fs = std::filesystem;

constexpr double kFlatSpread_m = 0.2;  ///< survey cells with max − min below this have one height

struct Map {
  Grid<float> elevation_m;
  Grid<float> state;
  double cell_m = 0.0, x_min_m = 0.0, y_min_m = 0.0;
};

struct Deviation {
  std::size_t n = 0;
  double sum = 0.0, sum2 = 0.0;
  void add(double e) { ++n, sum += e, sum2 += e * e; }
  double rmse() const { return n > 0 ? std::sqrt(sum2 / static_cast<double>(n)) : std::nan(""); }
  double bias() const { return n > 0 ? sum / static_cast<double>(n) : std::nan(""); }
};

struct Comparison {
  Deviation surface;       ///< against the mean of the scanned surface over the cell
  Deviation flat_surface;  ///< the same where the surface itself spreads less than kFlatSpread_m in the cell
  Deviation survey;        ///< against the survey's cell mean where its spread is below kFlatSpread_m
  std::size_t measured = 0;
  std::size_t invented = 0;  ///< measured cells whose neighbourhood holds no surface at all
};

[[noreturn]] void fail(const std::string& message) {
  std::fprintf(stderr, "survey_study: %s\n", message.c_str());
  std::exit(1);
}

void must(const test::Finished& finished, const std::string& what) {
  if (finished.exit_code != 0) fail(what + " ended with " + std::to_string(finished.exit_code) + "\n" + finished.err);
}

template <class T>
T must(Result<T> result) {
  if (!result) fail(result.error().message);
  return *std::move(result);
}

Map read_map(const fs::path& base) {
  Map map{must(io::read_npy(base.string() + ".elevation.npy")), must(io::read_npy(base.string() + ".cell_state.npy"))};
  const auto json = nlohmann::json::parse(std::ifstream(base.string() + ".json"));
  map.cell_m = json.at("cell_m");
  map.x_min_m = json.at("x_min_m");
  map.y_min_m = json.at("y_min_m");
  return map;
}

/// Bilinear between cell centres, the surface that the simulator scans; NaN outside or beside a hole.
double surface_at(const io::Raster& raster, double x_m, double y_m) {
  const double u = (x_m - raster.x_min_m) / raster.cell_m - 0.5;
  const double v = (y_m - raster.y_min_m) / raster.cell_y_m - 0.5;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  if (!raster.height_m.contains(row, column) || !raster.height_m.contains(row + 1, column + 1))
    return std::numeric_limits<double>::quiet_NaN();
  const double fu = u - column, fv = v - row;
  const auto& z = raster.height_m;
  return (1 - fv) * ((1 - fu) * z(row, column) + fu * z(row, column + 1)) +
         fv * ((1 - fu) * z(row + 1, column) + fu * z(row + 1, column + 1));
}

/// Mean and spread of the scanned surface over a map cell, from 7 × 7 places; n = how many of them have a surface.
struct CellSurface {
  double mean = 0.0, low = 1e9, high = -1e9;
  int n = 0;
};
CellSurface surface_in(const io::Raster& raster, double x_m, double y_m, double cell_m) {
  CellSurface cell;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) {
      const double z = surface_at(raster, x_m + (i + 0.5) / 7 * cell_m, y_m + (j + 0.5) / 7 * cell_m);
      if (std::isnan(z)) continue;
      cell.mean += z;
      cell.low = std::min(cell.low, z);
      cell.high = std::max(cell.high, z);
      ++cell.n;
    }
  if (cell.n > 0) cell.mean /= cell.n;
  return cell;
}

struct SurveyCell {
  double sum = 0.0, low = 1e9, high = -1e9;
  int n = 0;
};
Grid<SurveyCell> survey_cells(const io::PointCloud& cloud, const Map& map) {
  Grid<SurveyCell> cells(map.elevation_m.rows(), map.elevation_m.columns());
  for (const Eigen::Vector4f& p : cloud.points) {
    const int column = static_cast<int>(std::floor((p.x() + cloud.origin_m.x() - map.x_min_m) / map.cell_m));
    const int row = static_cast<int>(std::floor((p.y() + cloud.origin_m.y() - map.y_min_m) / map.cell_m));
    if (!cells.contains(row, column)) continue;
    SurveyCell& cell = cells(row, column);
    const double z = p.z() + cloud.origin_m.z();
    cell.sum += z;
    cell.low = std::min(cell.low, z);
    cell.high = std::max(cell.high, z);
    ++cell.n;
  }
  return cells;
}

Comparison compare(const Map& map, const io::Raster& surface, const Grid<SurveyCell>& survey) {
  Comparison result;
  for (int row = 0; row < map.elevation_m.rows(); ++row)
    for (int column = 0; column < map.elevation_m.columns(); ++column) {
      if (map.state(row, column) != static_cast<float>(CellState::measured)) continue;
      ++result.measured;
      const double z = map.elevation_m(row, column);
      const double x = map.x_min_m + column * map.cell_m, y = map.y_min_m + row * map.cell_m;
      const CellSurface here = surface_in(surface, x, y, map.cell_m);
      if (here.n == 0) {
        // noise of a few centimetres may move a return into the next cell; one cell of grace, not more
        if (surface_in(surface, x - map.cell_m, y - map.cell_m, 3 * map.cell_m).n == 0) ++result.invented;
      } else {
        result.surface.add(z - here.mean);
        if (here.high - here.low < kFlatSpread_m) result.flat_surface.add(z - here.mean);
      }
      const SurveyCell& truth = survey(row, column);
      if (truth.n >= 3 && truth.high - truth.low < kFlatSpread_m) result.survey.add(z - truth.sum / truth.n);
    }
  return result;
}

/// Simulate, replay into a listener, and return the map that the listener received.
Map drive(const std::string& scree, const std::string& survey, const std::string& sensor, const fs::path& folder) {
  const std::string recording = (folder / sensor).string(), base = (folder / (sensor + "_map")).string();
  must(test::run({scree, "simulate", "--terrain", survey, "--sensor", sensor, "--trajectory", "line:9,10,76,22,1.0",
                  "--noise", "nominal", "--seed", "1", "--out", recording},
                 std::chrono::minutes(8)),
       "simulate");
  test::Process listener({scree, "listen", "--address", "127.0.0.1:47913", "--map-out", base + ".npy", "--snapshot",
                          base + ".png", "--json"});
  if (!listener.wait_for_text("listening")) fail("the listener did not start: " + listener.err());
  must(test::run({scree, "replay", recording, "--rate", "max", "--set", "publish.destination=127.0.0.1:47913", "--set",
                  "publish.listen=127.0.0.1:0", "--json"},
                 std::chrono::minutes(8)),
       "replay");
  must(listener.wait(), "listen");
  return read_map(base);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: survey_study SCREE SURVEY.bin [FOLDER_TO_KEEP]");
  const std::string scree = argv[1], survey_file = argv[2];
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);
  const auto cloud = must(io::read_point_cloud(survey_file));
  std::printf(
      "| sensor | measured cells | RMSE (bias) against the scanned surface, m | same, cells whose surface spreads < "
      "0.2 m "
      "| RMSE (bias) against the survey's cell means, m | cells | measured where there is no ground "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const std::string sensor : {"perceptron-usf", "perceptron-cmu"}) {
    const Map map = drive(scree, survey_file, sensor, folder);
    const auto surface = must(io::read_raster(folder / sensor / "truth" / "terrain.tif"));
    const Comparison c = compare(map, surface, survey_cells(cloud, map));
    std::printf("| %s | %zu | %.4f (%+.4f) | %.4f (%+.4f), n = %zu | %.4f (%+.4f) | %zu | %zu |\n", sensor.c_str(),
                c.measured, c.surface.rmse(), c.surface.bias(), c.flat_surface.rmse(), c.flat_surface.bias(),
                c.flat_surface.n, c.survey.rmse(), c.survey.bias(), c.survey.n, c.invented);
    std::fflush(stdout);
  }
}
