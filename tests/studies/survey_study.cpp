// The whole chain on a real survey: simulate a drive over it, replay the recording through the node, receive the map
// by UDP, and hold the received map against the surface that was scanned and against the survey itself.
// Prints the tables "Over a real survey" of docs/accuracy.md.  Usage: survey_study SCREE SURVEY.bin [FOLDER_TO_KEEP]

#include <array>

#include "tests/studies/survey_surface.hpp"

namespace {

using namespace scree;
using namespace scree::study;

struct Drive {
  const char* name;
  const char* trajectory;
};
/// Towards and past the trees at the survey's east side; past the trees at its south side; over open ground.
constexpr std::array<Drive, 3> kDrives{{{"towards trees", "line:20,38,-40,11,1"},
                                        {"past trees", "line:22,31,220,9.5,1"},
                                        {"open ground", "line:13,31,30,13.4,1"}}};

struct Comparison {
  std::size_t measured = 0;
  std::size_t beside = 0;         ///< measured cells without surface, but with some in a neighbouring cell
  std::size_t invented = 0;       ///< measured cells without surface in the 3 × 3 cells around
  Deviation all, flat, open;      ///< against the surface: every cell; small spread in it; in the 3 × 3 around
  Deviation survey, survey_open;  ///< against the survey's cell means: small spread; in the 3 × 3 around
  std::size_t open_off = 0;       ///< open cells off by more than 0.2 m
  double sigmas2 = 0.0;           ///< sum of (error/sigma)² over the open cells
};

Comparison compare(const Map& map, const Grid<float>& sigma_m, const Grid<Heights>& surface,
                   const Grid<Heights>& survey) {
  Comparison result;
  for (int row = 0; row < map.state.rows(); ++row)
    for (int column = 0; column < map.state.columns(); ++column) {
      if (!map.measured(row, column)) continue;
      ++result.measured;
      const double z = map.elevation_m(row, column);
      const Heights& here = surface(row, column);
      if (here.n == 0) {
        const bool nothing = around(surface, row, column, [](const Heights& h) { return h.n == 0; });
        ++(nothing ? result.invented : result.beside);
      } else {
        const double error = z - here.mean();
        result.all.add(error);
        if (here.flat()) result.flat.add(error);
        if (around(surface, row, column, [](const Heights& h) { return h.flat(); })) {
          result.open.add(error);
          result.open_off += std::abs(error) > kFlatSpread_m;
          result.sigmas2 += std::pow(error / sigma_m(row, column), 2);
        }
      }
      const Heights& points = survey(row, column);
      if (!points.flat()) continue;
      result.survey.add(z - points.mean());
      if (around(survey, row, column, [](const Heights& h) { return h.flat(); }))
        result.survey_open.add(z - points.mean());
    }
  return result;
}

/// Simulate, replay into a listener, and return what the node counted; the listener's map is in `base`.
nlohmann::json drive(const std::string& scree, const std::string& survey, const std::string& sensor,
                     const std::string& trajectory, const fs::path& base) {
  must_run({scree, "simulate", "--terrain", survey, "--sensor", sensor, "--trajectory", trajectory, "--noise",
            "nominal", "--seed", "1", "--out", base.string()});
  test::Process listener({scree, "listen", "--address", "127.0.0.1:47913", "--map-out", base.string() + ".npy",
                          "--snapshot", base.string() + ".png", "--json"});
  if (!listener.wait_for_text("listening")) fail("the listener did not start: " + listener.err());
  const auto node = nlohmann::json::parse(
      must_run({scree, "replay", base.string(), "--rate", "max", "--set", "publish.destination=127.0.0.1:47913",
                "--set", "publish.listen=127.0.0.1:0", "--set", "map.size_cells=400", "--map-out",
                base.string() + "_node.npy", "--json"}));
  const test::Finished heard = listener.wait();
  if (heard.exit_code != 0) fail("listen ended with " + std::to_string(heard.exit_code) + "\n" + heard.err);
  if (nlohmann::json::parse(heard.out).at("cells_measured") != node.at("cells_measured"))
    fail("the listener has another number of measured cells than the node");
  return node;
}

void print(const char* name, const std::string& sensor, const nlohmann::json& node, const Comparison& c) {
  const auto& pixels = node.at("pixels");
  const auto pixel = [&](const char* key) { return pixels.at(key).get<double>(); };
  const double returns = pixel("pixels") - pixel("no_return") - pixel("untrusted_row");
  std::printf(
      "| %s, %s | %zu | %.1f | %.1f, %zu | %.1f (%+.1f), %zu | %zu | %.2f | %.1f, %zu | %.1f (%+.1f), %zu | %zu, %zu | "
      "%.1f, %.1f |\n",
      name, sensor.c_str() + std::string("perceptron-").size(), c.measured, 1e3 * c.all.rmse(), 1e3 * c.flat.rmse(),
      c.flat.n, 1e3 * c.open.rmse(), 1e3 * c.open.bias(), c.open.n, c.open_off,
      c.sigmas2 / static_cast<double>(c.open.n), 1e3 * c.survey.rmse(), c.survey.n, 1e3 * c.survey_open.rmse(),
      1e3 * c.survey_open.bias(), c.survey_open.n, c.beside, c.invented, 100 * pixel("ambiguous") / returns,
      100 * (pixel("speckle") + pixel("mixed")) / returns);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: survey_study SCREE SURVEY.bin [FOLDER_TO_KEEP]");
  const std::string scree = argv[1], survey_file = argv[2];
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);
  const auto cloud = must(io::read_point_cloud(survey_file));
  std::puts(
      "| drive, sensor | measured cells | all: RMSE, mm | flat: RMSE, n | open: RMSE (bias), n | open off > 0.2 m "
      "| open: mean (error/sigma)² | survey flat: RMSE, n | survey open: RMSE (bias), n | no surface: beside, "
      "invented | ambiguous, filtered, % |\n|---|---|---|---|---|---|---|---|---|---|---|");
  for (const Drive& way : kDrives)
    for (const std::string sensor : {"perceptron-usf", "perceptron-cmu"}) {
      std::string name = std::string(way.name) + "-" + sensor;
      std::replace(name.begin(), name.end(), ' ', '_');
      const fs::path base = folder / name;
      const auto node = drive(scree, survey_file, sensor, way.trajectory, base);
      const Map map = read_map(base);
      const auto surface = must(io::read_raster(base / "truth" / "terrain.tif"));
      // the standard deviations do not travel in datagrams
      const auto sigma_m = must(io::read_npy(base.string() + "_node.elevation_sigma.npy"));
      print(way.name, sensor, node, compare(map, sigma_m, surface_cells(surface, map), survey_cells(cloud, map)));
    }
}
