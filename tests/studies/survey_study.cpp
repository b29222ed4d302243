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
  const char* noise;
};
/// Towards and past the trees at the survey's east side; past the trees at its south side; over open ground.
constexpr std::array<Drive, 4> kDrives{{{"towards trees", "line:20,38,-40,11,1", "nominal"},
                                        {"past trees", "line:22,31,220,9.5,1", "nominal"},
                                        {"open ground", "line:13,31,30,13.4,1", "nominal"},
                                        {"open ground, noise off", "line:13,31,30,13.4,1", "off"}}};

struct Comparison {
  std::size_t measured = 0;
  std::size_t beside = 0;         ///< measured cells without surface, but with some in a neighbouring cell
  std::size_t invented = 0;       ///< measured cells without surface in the 3 × 3 cells around
  Deviation all, flat, open;      ///< against the surface: every cell; small spread in it; in the 3 × 3 around
  Deviation survey, survey_open;  ///< against the survey's cell means: small spread; in the 3 × 3 around
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
nlohmann::json drive(const std::string& scree, const std::string& survey, const std::string& sensor, const Drive& way,
                     const fs::path& base) {
  must_run({scree, "simulate", "--terrain", survey, "--sensor", sensor, "--trajectory", way.trajectory, "--noise",
            way.noise, "--seed", "1", "--out", base.string()});
  test::Process listener({scree, "listen", "--address", "127.0.0.1:0", "--map-out", base.string() + ".npy",
                          "--snapshot", base.string() + ".png", "--json"});
  if (!listener.wait_for_text("listening at ")) fail("the listener did not start: " + listener.err());
  const std::string log = listener.err();
  const std::size_t at = log.find("listening at ") + std::string_view("listening at ").size();
  const std::string address = log.substr(at, log.find_first_of(" \n", at) - at);  // port 0: the kernel chose one
  const auto node =
      nlohmann::json::parse(must_run({scree, "replay", base.string(), "--rate", "max", "--set",
                                      "publish.destination=" + address, "--set", "publish.listen=127.0.0.1:0", "--set",
                                      "map.size_cells=400", "--map-out", base.string() + "_node.npy", "--json"}));
  const test::Finished heard = listener.wait();
  if (heard.exit_code != 0) fail("listen ended with " + std::to_string(heard.exit_code) + "\n" + heard.err);
  if (nlohmann::json::parse(heard.out).at("cells_measured") != node.at("cells_measured"))
    fail("the listener has another number of measured cells than the node");
  return node;
}

void print_errors(const std::string& name, const Comparison& c) {
  for (const auto& [cells, d] : {std::pair("all", &c.all), std::pair("flat", &c.flat), std::pair("open", &c.open),
                                 std::pair("survey, flat", &c.survey), std::pair("survey, open", &c.survey_open)})
    std::printf("| %s | %s | %zu | %.1f | %+.1f | %.1f | %.1f | %.2f | %zu |\n", name.c_str(), cells, d->n(),
                1e3 * d->rmse(), 1e3 * d->bias(), 1e3 * d->within(0.5), 1e3 * d->within(0.99), d->within(1.0),
                d->beyond(kFlatSpread_m));
  std::fflush(stdout);
}

void print_counts(const std::string& name, const nlohmann::json& node, const Comparison& c) {
  const auto pixel = [&](const char* key) { return node.at("pixels").at(key).get<double>(); };
  const double returns = pixel("pixels") - pixel("no_return") - pixel("untrusted_row");
  std::printf("| %s | %zu | %zu, %zu | %.2f | %.1f | %.1f | %.2f |\n", name.c_str(), c.measured, c.beside, c.invented,
              c.sigmas2 / static_cast<double>(c.open.n()), 100 * pixel("ambiguous") / returns,
              100 * (pixel("speckle") + pixel("mixed")) / returns,
              100 * node.at("points_outlier").get<double>() / node.at("points").get<double>());
}

struct Row {
  std::string name;
  nlohmann::json node;
  Comparison comparison;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: survey_study SCREE SURVEY.bin [FOLDER_TO_KEEP]");
  const std::string scree = argv[1], survey_file = argv[2];
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);
  const auto cloud = must(io::read_point_cloud(survey_file));
  std::puts(
      "| drive, sensor | cells | n | RMSE, mm | bias, mm | median, mm | 99 %, mm | largest, m | off > 0.2 m "
      "|\n|---|---|---|---|---|---|---|---|---|");
  std::vector<Row> table;
  for (const Drive& way : kDrives)
    for (const std::string sensor : {"perceptron-usf", "perceptron-cmu"}) {
      const std::string name = std::string(way.name) + ", " + sensor.substr(std::string("perceptron-").size());
      const fs::path base = folder / ("drive_" + std::to_string(table.size()));
      const auto node = drive(scree, survey_file, sensor, way, base);
      const Map map = read_map(base);
      const auto surface = must(io::read_raster(base / "truth" / "terrain.tif"));
      // the standard deviations do not travel in datagrams
      const auto sigma_m = must(io::read_npy(base.string() + "_node.elevation_sigma.npy"));
      table.push_back({name, node, compare(map, sigma_m, surface_cells(surface, map), survey_cells(cloud, map))});
      print_errors(name, table.back().comparison);
    }
  std::puts(
      "\n| drive, sensor | measured cells | without surface: beside, invented | open: mean (error/sigma)² | ambiguous, "
      "% | "
      "filtered, % | contradict the map, % |\n|---|---|---|---|---|---|---|");
  for (const Row& row : table) print_counts(row.name, row.node, row.comparison);
}
