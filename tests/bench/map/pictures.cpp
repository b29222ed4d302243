// What the map looks like beside the truth, and the areas under the ROC over D.

#include <filesystem>
#include <fstream>
#include <limits>

#include "io/picture.hpp"
#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"
#include "tests/bench/map/chart.hpp"
#include "tests/bench/map/truth/drive.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

void report(const std::filesystem::path& file, const Status& status) {
  print_text(status ? fmt::format("\n![{0}]({0})", file.filename().string())
                    : "\nNo picture: " + status.error().message);
}

/// Cells of the map's window as values of `value(row, column)`.
template <class Value>
Grid<float> grid_of(const mapping::MapSnapshot& map, const Value& value) {
  Grid<float> out(map.window.rows, map.window.columns, kUnknown);
  for (int row = 0; row < out.rows(); ++row)
    for (int column = 0; column < out.columns(); ++column) out(row, column) = value(row, column);
  return out;
}

/// A grid of the truth, cut to the map's window.
template <class T>
Grid<float> cut_truth(const mapping::MapSnapshot& map, const SceneTruth& truth, const Grid<T>& values) {
  return grid_of(map, [&](int row, int column) {
    const int r = row + map.window.min.y - truth.cells.min.y, c = column + map.window.min.x - truth.cells.min.x;
    return values.contains(r, c) ? static_cast<float>(values(r, c)) : kUnknown;
  });
}

io::PicturePanel heights(const std::string& title, Grid<float> values, std::pair<double, double> limits) {
  return {title, std::move(values), {io::ColourMap::terrain, limits.first, limits.second, true}};
}
io::PicturePanel plain(const std::string& title, Grid<float> values, double min, double max,
                       io::ColourMap map = io::ColourMap::viridis) {
  return {title, std::move(values), {map, min, max, false}};
}

struct Scene {
  const char* name;
  const char* sensor;
  GroundSpec spec;
};

void map_pictures(const std::filesystem::path& folder, const Scene& scene) {
  const Ground ground = must(make_ground(scene.spec));
  const SceneTruth truth = scene_truth(ground, {});
  const GroundFile file(ground);
  const DrivenMaps maps = map_drive(render_all(simulator_over(file, scene.sensor, scene.spec.seed)), {});
  const mapping::MapSnapshot& map = *maps.map;
  const io::PictureFrame frame{map.window.min.x * map.cell_m, map.window.min.y * map.cell_m, map.cell_m};
  const io::RobotMark robot{map.T_map_body.translation_m.x(), map.T_map_body.translation_m.y(), 0.0};
  const Grid<float> true_height = cut_truth(map, truth, truth.height_m);
  const auto [low, high] = std::minmax_element(true_height.begin(), true_height.end());
  const std::pair<double, double> limits(*low, *high);
  Grid<float> shares = cut_truth(map, truth, truth.worst_share);
  const Grid<float> impassable = grid_of(
      map, [&](int r, int c) { return std::isnan(shares(r, c)) ? kUnknown : (shares(r, c) > 1.0F ? 1.0F : 0.0F); });
  const std::string caption = fmt::format("{}, D {:.1f}, rms change over 0.3 m {:g} m, after 7 m of driving",
                                          scene.sensor, scene.spec.dimension, scene.spec.relief_m);
  std::vector<io::PicturePanel> top = {heights("true height (m)", true_height, limits),
                                       heights("elevation, one draw (m)", map.elevation_m, limits)};
  if (!map.elevation_mean_m.empty()) top.push_back(heights("elevation mean (m)", map.elevation_mean_m, limits));
  top.push_back(plain("elevation sigma (m)", map.elevation_sigma_m, 0.0, 0.1));
  const Grid<float> states = grid_of(map, [&](int r, int c) { return static_cast<float>(map.state(r, c)); });
  top.push_back(plain("state (4 measured ... 0 never seen)", states, 0.0, 4.0));
  const auto write = [&](const char* what, const std::vector<io::PicturePanel>& panels) {
    const auto png = folder / fmt::format("map-{}-{}.png", scene.name, what);
    report(png, io::write_map_picture(png, panels, frame, robot, caption));
  };
  write("heights", top);
  const Grid<float> cost = grid_of(map, [&](int r, int c) {
    return map.cost(r, c) == mapping::kCostUnknown ? kUnknown : static_cast<float>(map.cost(r, c));
  });
  std::vector<io::PicturePanel> bottom = {plain("D", map.dimension, 2.0, 3.0),
                                          plain("cost", cost, 0.0, 254.0, io::ColourMap::cost)};
  if (!map.risk.empty()) bottom.push_back(plain("risk", map.risk, 0.0, 1.0, io::ColourMap::cost));
  bottom.push_back(plain("truth: impassable at the worst heading", impassable, 0.0, 1.0, io::ColourMap::cost));
  for (float& share : shares) share = std::min(share, 2.0F);
  bottom.push_back(plain("truth: largest share of a limit", shares, 0.0, 2.0));
  write("cost", bottom);
}

struct Curve {
  const char* name;
  Method method;
  io::Colour colour;
  bool dashed;
};
constexpr std::array kCurves = {Curve{"cost", kCost, {31, 119, 180}, false},
                                Curve{"risk", kRisk, {44, 160, 44}, false},
                                Curve{"smooth fill, relief", kRelief, {214, 39, 40}, true},
                                Curve{"slope, step, roughness", kPlane, {255, 127, 14}, true},
                                Curve{"smooth fill, footprint (no baseline in use)", kFootprint, {150, 150, 150}, true},
                                Curve{"true cells, footprint", kCeiling, {0, 0, 0}, true}};

ScoreCounts pooled(const Scenes& scenes, CellClass kind, Method method) {
  ScoreCounts sum;
  for (const Judgement* scene : scenes) sum += scene->scores[kind][method];
  return sum;
}

Chart area_chart(const SensorResults& r, CellClass kind, const char* cells) {
  Chart chart{fmt::format("{}, {}", r.sensor, cells), "D", "area under the ROC", 2.05, 2.85, 0.5, 1.0, {}};
  for (const Curve& curve : kCurves) {
    ChartLine line{curve.name, {}, {}, {}, {}, curve.colour, curve.dashed};
    for (const double d : kDimensions) {
      const Scenes scenes = scenes_of(r.scenes, d);
      if (scenes.empty() || pooled(scenes, kind, curve.method).cells() == 0.0) continue;
      const Interval area = bootstrap(scenes, [&](const Scenes& s) { return pooled(s, kind, curve.method).auc(); });
      line.x.push_back(d), line.y.push_back(area.value), line.low.push_back(area.low), line.high.push_back(area.high);
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

Chart roc_chart(const SensorResults& r) {
  Chart chart{
      fmt::format("ROC, {}, all D", r.sensor), "passable cells refused", "impassable cells refused", 0, 1, 0, 1, {}};
  for (const Curve& curve : kCurves) {
    const ScoreCounts counts = pooled(scenes_of(r.scenes), kAllCells, curve.method);
    ChartLine line{curve.name, {}, {}, {}, {}, curve.colour, curve.dashed};
    if (counts.cells() > 0.0)
      for (const auto& [alarms, detections] : roc(counts)) line.x.push_back(alarms), line.y.push_back(detections);
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

void charts(const std::filesystem::path& folder) {
  std::vector<Chart> areas, rocs;
  for (const SensorResults& r : campaign()) areas.push_back(area_chart(r, kAllCells, "all cells"));
  for (const SensorResults& r : campaign()) areas.push_back(area_chart(r, kReconstructedCells, "reconstructed cells"));
  for (const SensorResults& r : campaign()) rocs.push_back(roc_chart(r));
  report(folder / "map-area-by-dimension.png",
         io::write_drawing(folder / "map-area-by-dimension.png", draw_charts(areas, 4)));
  report(folder / "map-roc.png", io::write_drawing(folder / "map-roc.png", draw_charts(rocs, 4)));
}

}  // namespace

void pictures_section() {
  print_text("\n## Pictures");
  if (pictures.empty()) {
    print_text("\nNone asked for (`--pictures FOLDER`).");
    return;
  }
  std::error_code ignored;
  std::filesystem::create_directories(pictures, ignored);
  charts(pictures);
  map_pictures(pictures, {"perceptron", "perceptron-cmu", {2.3, 0.065, 501}});
  map_pictures(pictures, {"lidar", "lidar64", {2.7, 0.05, 502}});
}

}  // namespace scree::bench
