// A Perceptron file whose truth is known, replayed without and with the pose of its sensor: how far the measured cells
// lie from the mean of the true points in them, and how many were made of the random sky.
// Prints the table "The synthetic Perceptron file" of docs/accuracy.md.  Usage: synthetic_study SCREE DATA [FOLDER]

#include "tests/studies/study.hpp"
#include "tests/studies/survey_surface.hpp"
#include "tests/support/synthetic_file.hpp"

namespace {

using namespace scree;
using namespace scree::study;

void print(const std::string& name, const nlohmann::json& node, const Map& map,
           const std::vector<Eigen::Vector3d>& truth) {
  Grid<Heights> cells(map.state.rows(), map.state.columns());
  for (const Eigen::Vector3d& p : truth) {
    const int column = static_cast<int>(std::floor((p.x() - map.x_min_m) / map.cell_m));
    const int row = static_cast<int>(std::floor((p.y() - map.y_min_m) / map.cell_m));
    if (p.allFinite() && cells.contains(row, column)) cells(row, column).add(p.z());
  }
  std::size_t measured = 0, beside = 0, sky = 0;
  Deviation all, flat;
  for (int row = 0; row < cells.rows(); ++row)
    for (int column = 0; column < cells.columns(); ++column) {
      if (!map.measured(row, column)) continue;
      ++measured;
      const Heights& here = cells(row, column);
      if (here.n == 0) {
        ++(around(cells, row, column, [](const Heights& h) { return h.n == 0; }) ? sky : beside);
        continue;
      }
      const double error = map.elevation_m(row, column) - here.mean();
      all.add(error);
      if (here.flat()) flat.add(error);
    }
  if (all.n() == 0) fail(name + ": no cell was measured where there is ground");
  std::printf("| %s | %zu | %zu | %.1f, %zu | %.1f (%+.1f), %zu | %.1f | %.0f | %zu, %zu |\n", name.c_str(),
              node.at("points").get<std::size_t>(), measured, 1e3 * all.rmse(), all.n(), 1e3 * flat.rmse(),
              1e3 * flat.bias(), flat.n(), 1e3 * all.within(0.5), 1e3 * all.within(1.0), beside, sky);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: synthetic_study SCREE DATA [FOLDER_TO_KEEP]");
  const fs::path data = fs::path(argv[2]) / "perceptron_SYNTHETIC";
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);
  test::write_synthetic_config(folder / "sensor.yaml");
  std::puts(
      "| replayed | points | measured cells | RMSE, mm, n | cells of one height: RMSE (bias), mm, n | median error, mm "
      "| largest, mm | no surface: beside, in the sky |\n|---|---|---|---|---|---|---|---|");
  for (const bool with_pose : {false, true}) {
    const fs::path base = folder / (with_pose ? "posed" : "bare");
    std::vector<std::string> command{argv[1],
                                     "replay",
                                     (data / "synthetic_msh.perc").string(),
                                     "--rate",
                                     "max",
                                     "--json",
                                     "--map-out",
                                     base.string() + ".npy",
                                     "--snapshot",
                                     base.string() + ".png",
                                     "--set",
                                     "publish.destination=127.0.0.1:9",
                                     "--set",
                                     "publish.listen=127.0.0.1:0"};
    if (with_pose) command.insert(command.end(), {"--config", (folder / "sensor.yaml").string()});
    const auto node = nlohmann::json::parse(must_run(command));
    const Pose bare{Eigen::Vector3d::Zero(), test::body_from_perceptron()};
    print(with_pose ? "with the sensor's pose" : "bare", node, read_map(base),
          test::synthetic_truth(data / "synthetic_msh.truth_t_cm.f32",
                                with_pose ? test::synthetic_T_body_sensor() : bare));
  }
}
