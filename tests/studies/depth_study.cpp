// Real depth frames through the node: what becomes of their pixels, and how well frames agree with each other.
// Prints the tables "Real depth cameras" of docs/accuracy.md.  Usage: depth_study SCREE DATA [FOLDER_TO_KEEP]

#include <algorithm>

#include "tests/studies/study.hpp"
#include "tests/support/depth_recording.hpp"

namespace {

using namespace scree;
using namespace scree::study;

constexpr double kOutlier_m = 0.1;

nlohmann::json replay(const std::string& scree, const fs::path& recording, const fs::path& base,
                      std::vector<std::string> more = {}) {
  return replay_map(scree, recording, base, {"map.cell_m=0.05", "map.size_cells=400"}, std::move(more));
}

void print_pixels(const std::string& name, const nlohmann::json& node) {
  const auto& pixels = node.at("pixels");
  const auto share = [&](const char* key) {
    return 100 * pixels.at(key).get<double>() / pixels.at("pixels").get<double>();
  };
  const double points = node.at("points").get<double>();
  std::printf("| %s | %d, %d | %.2f | %.2f | %.2f | %.2f | %.2f | %zu | %.2f |\n", name.c_str(),
              node.at("frames_in").get<int>(), node.at("frames_skipped").get<int>(), share("no_return"),
              share("out_of_limits"), share("speckle") + share("mixed"), share("points"), share("ambiguous"),
              node.at("cells_measured").get<std::size_t>(), 100 * node.at("points_outlier").get<double>() / points);
}

/// Cells whose step is below this hold one height, which two views must agree on; a wall's cell does not.
constexpr float kOneHeight_m = 0.1F;

struct FrameMap {
  Map map;
  Grid<float> step_m;
  bool level(int row, int column) const { return step_m(row, column) < kOneHeight_m; }
};

FrameMap read_frame_map(const fs::path& base) {
  return {read_map(base), must(io::read_npy(base.string() + ".step.npy"))};
}

struct Differences {
  std::vector<double> signed_m, size_m;
  void add(double d) {
    signed_m.push_back(d);
    size_m.push_back(std::abs(d));
  }
  void print() {
    if (signed_m.empty()) fail("two frames share no such cell");
    std::sort(signed_m.begin(), signed_m.end());
    std::sort(size_m.begin(), size_m.end());
    const auto at = [](const std::vector<double>& sorted, double q) {
      return 1e3 * sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
    };
    const auto beyond = size_m.end() - std::upper_bound(size_m.begin(), size_m.end(), kOutlier_m);
    std::printf(" %zu | %+.0f | %.0f, %.0f | %.1f |", size_m.size(), at(signed_m, 0.5), at(size_m, 0.5),
                at(size_m, 0.9), 100.0 * static_cast<double>(beyond) / static_cast<double>(size_m.size()));
  }
};

/// Heights of one frame alone less those of the frames before it, over the cells that both measured.
void print_agreement(int frame, const FrameMap& alone, const FrameMap& before) {
  const int dx = static_cast<int>(std::lround((alone.map.x_min_m - before.map.x_min_m) / before.map.cell_m));
  const int dy = static_cast<int>(std::lround((alone.map.y_min_m - before.map.y_min_m) / before.map.cell_m));
  Differences level, other;
  for (int row = 0; row < alone.map.state.rows(); ++row)
    for (int column = 0; column < alone.map.state.columns(); ++column) {
      const int r = row + dy, c = column + dx;
      if (!alone.map.measured(row, column) || !before.map.state.contains(r, c) || !before.map.measured(r, c)) continue;
      const double difference_m = alone.map.elevation_m(row, column) - before.map.elevation_m(r, c);
      (alone.level(row, column) && before.level(r, c) ? level : other).add(difference_m);
    }
  std::printf("| %d |", frame);
  level.print();
  other.print();
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: depth_study SCREE DATA [FOLDER_TO_KEEP]");
  const std::string scree = argv[1];
  const fs::path data = argv[2];
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);

  std::puts(
      "| recording | frames in, skipped | no return, % | out of limits, % | speckle + mixed, % | points, % | "
      "ambiguous, % "
      "| measured cells | points that contradict the map, % |\n|---|---|---|---|---|---|---|---|---|");
  const fs::path kinect = folder / "kinect";
  test::write_kinect_recording(data / "rgbd_kinect_slambook2", kinect);
  print_pixels("Kinect, 5 frames", replay(scree, kinect, folder / "kinect_map"));
  for (const std::string name : {"one_cloud", "hand"}) {
    test::write_realsense_recording(data / "realsense_d435_bag" / (name + "_depth_z16_848x480.pgm"), folder / name);
    print_pixels("D435 " + name, replay(scree, folder / name, folder / (name + "_map")));
  }

  std::puts("");
  print_cost_heading();
  print_costs("Kinect", folder / "kinect_map");

  std::puts(
      "\n| Kinect frame against those before | level cells in common | median, mm | size: median, 90 %, mm | beyond "
      "0.1 m, % | other cells in common | median, mm | size: median, 90 %, mm | beyond 0.1 m, % "
      "|\n|---|---|---|---|---|---|---|---|---|");
  for (int frame = 2; frame <= 5; ++frame) {
    const std::string start = std::to_string(frame - 1);
    replay(scree, kinect, folder / "alone", {"--start", start, "--duration", "0.5"});
    replay(scree, kinect, folder / "before", {"--duration", std::to_string(frame - 2) + ".5"});
    print_agreement(frame, read_frame_map(folder / "alone"), read_frame_map(folder / "before"));
  }
}
