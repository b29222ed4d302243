// The real binary on real recordings, where the shared data is beside the checkout.

#include <array>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/cell_state.hpp"
#include "io/npy.hpp"
#include "tests/integration/scree.hpp"
#include "tests/support/depth_recording.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/synthetic_file.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

/// Cells and what the node counted, of a replay at full speed with 5 cm cells.
struct Replayed {
  json node;
  Grid<float> elevation_m, state, step_m;
  double cell_m = 0.0, x_min_m = 0.0, y_min_m = 0.0;
  bool measured(int row, int column) const { return state(row, column) == static_cast<float>(CellState::measured); }
  double share(const char* pixels) const {
    return node["pixels"][pixels].get<double>() / node["pixels"]["pixels"].get<double>();
  }
};

Grid<float> layer(const TemporaryFolder& folder, const std::string& name) {
  auto grid = io::read_npy(folder / ("map." + name + ".npy"));
  EXPECT_TRUE(grid) << grid.error().message;
  return grid ? *std::move(grid) : Grid<float>();
}

Replayed replayed(const std::filesystem::path& recording, std::vector<std::string> more = {}) {
  const TemporaryFolder folder;
  more.insert(more.end(), {"--rate", "max", "--json", "--map-out", (folder / "map.npy").string()});
  const auto finished = scree(replay(recording.string(), more));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  Replayed out;
  if (finished.exit_code != 0) return out;
  out.node = json::parse(finished.out);
  out.elevation_m = layer(folder, "elevation");
  out.state = layer(folder, "cell_state");
  out.step_m = layer(folder, "step");
  const json map = json::parse(read_file(folder / "map.json"));
  out.cell_m = map["cell_m"];
  out.x_min_m = map["x_min_m"];
  out.y_min_m = map["y_min_m"];
  return out;
}

const std::vector<std::string> kIndoorMap{"--set", "map.cell_m=0.05", "--set", "map.size_cells=400"};

std::vector<std::string> indoor(std::vector<std::string> more) {
  more.insert(more.end(), kIndoorMap.begin(), kIndoorMap.end());
  return more;
}

constexpr const char* kKinect = "rgbd_kinect_slambook2";

TEST(RealData, KinectFramesAllReachTheMap) {
  const auto data = shared_data(kKinect);
  SCREE_SKIP_WITHOUT(data, kKinect);
  const TemporaryFolder folder;
  write_kinect_recording(*data, folder / "kinect");
  const Replayed map = replayed(folder / "kinect", kIndoorMap);
  EXPECT_EQ(map.node["frames_in"], 5);
  EXPECT_EQ(map.node["frames_mapped"], 5);
  EXPECT_EQ(map.node["frames_skipped"], 0);
  // 28–32 % of the pixels of each frame hold no measurement; filters take some of the rest, but not much of it
  EXPECT_GT(map.share("no_return"), 0.28);
  EXPECT_LT(map.share("no_return"), 0.32);
  EXPECT_GT(map.share("points"), 0.98 * (1.0 - map.share("no_return")));
  EXPECT_EQ(map.node["pixels"]["ambiguous"], 0);
  // a room of some 9 m: the farthest measured cell lies within the reach of a Kinect
  double farthest_m = 0.0;
  for (int row = 0; row < map.state.rows(); ++row)
    for (int column = 0; column < map.state.columns(); ++column)
      if (map.measured(row, column))
        farthest_m =
            std::max(farthest_m, std::hypot(map.x_min_m + column * map.cell_m, map.y_min_m + row * map.cell_m));
  EXPECT_GT(farthest_m, 6.0);
  EXPECT_LT(farthest_m, 12.0);
}

TEST(RealData, KinectFramesAgreeOnTheFloor) {
  const auto data = shared_data(kKinect);
  SCREE_SKIP_WITHOUT(data, kKinect);
  const TemporaryFolder folder;
  write_kinect_recording(*data, folder / "kinect");
  const Replayed before = replayed(folder / "kinect", indoor({"--duration", "3.5"}));
  const Replayed alone = replayed(folder / "kinect", indoor({"--start", "4"}));
  ASSERT_EQ(before.node["frames_in"], 4);
  ASSERT_EQ(alone.node["frames_in"], 1);
  const int dx = static_cast<int>(std::lround((alone.x_min_m - before.x_min_m) / before.cell_m));
  const int dy = static_cast<int>(std::lround((alone.y_min_m - before.y_min_m) / before.cell_m));
  int common = 0, off = 0, on_floor = 0;
  for (int row = 0; row < alone.state.rows(); ++row)
    for (int column = 0; column < alone.state.columns(); ++column) {
      const int r = row + dy, c = column + dx;
      if (!before.state.contains(r, c) || !alone.measured(row, column) || !before.measured(r, c)) continue;
      if (!(alone.step_m(row, column) < 0.1F && before.step_m(r, c) < 0.1F)) continue;  // a wall has no one height
      ++common;
      off += std::abs(alone.elevation_m(row, column) - before.elevation_m(r, c)) > 0.1F;
      on_floor += std::abs(alone.elevation_m(row, column)) < 0.1F;
    }
  EXPECT_GT(common, 500);
  EXPECT_LT(off, common / 50);
  EXPECT_GT(on_floor, common / 2);  // turned poses, extrinsics and intrinsics put the floor at 0, and level
}

TEST(RealData, RealSenseFramesBecomePoints) {
  // valid pixels by the data's description; the lens saw up to 24 m, the recording says 10 m
  for (const auto& [name, valid] : {std::pair("one_cloud", 0.454), std::pair("hand", 0.510)}) {
    const std::string relative = std::string("realsense_d435_bag/") + name + "_depth_z16_848x480.pgm";
    const auto image = shared_data(relative);
    SCREE_SKIP_WITHOUT(image, relative);
    const TemporaryFolder folder;
    write_realsense_recording(*image, folder / "realsense");
    const Replayed map = replayed(folder / "realsense", kIndoorMap);
    EXPECT_EQ(map.node["frames_in"], 1) << name;
    EXPECT_EQ(map.node["frames_skipped"], 0) << name;
    EXPECT_NEAR(1.0 - map.share("no_return"), valid, 0.001) << name;
    EXPECT_GT(map.share("points") + map.share("out_of_limits"), 0.98 * valid) << name;
    EXPECT_GT(map.node["cells_measured"], 1000) << name;
  }
}

constexpr const char* kSynthetic = "perceptron_SYNTHETIC/synthetic_msh.perc";

class SyntheticPerceptron : public testing::TestWithParam<bool> {};

TEST_P(SyntheticPerceptron, MeasuredCellsLieOnItsTruthAndNoneInItsSky) {
  const auto file = shared_data(kSynthetic);
  SCREE_SKIP_WITHOUT(file, kSynthetic);
  const TemporaryFolder folder;
  write_synthetic_config(folder / "sensor.yaml");
  const Pose bare{Eigen::Vector3d::Zero(), body_from_perceptron()};
  const Replayed map = GetParam() ? replayed(*file, {"--config", (folder / "sensor.yaml").string()}) : replayed(*file);
  Grid<double> sum(map.state.rows(), map.state.columns(), 0.0);
  Grid<int> count(map.state.rows(), map.state.columns(), 0);
  for (const auto& p : synthetic_truth(file->parent_path() / "synthetic_msh.truth_t_cm.f32",
                                       GetParam() ? synthetic_T_body_sensor() : bare)) {
    const int column = static_cast<int>(std::floor((p.x() - map.x_min_m) / map.cell_m));
    const int row = static_cast<int>(std::floor((p.y() - map.y_min_m) / map.cell_m));
    if (!p.allFinite() || !sum.contains(row, column)) continue;
    sum(row, column) += p.z();
    ++count(row, column);
  }
  int measured = 0, without_surface = 0;
  double squares = 0.0;
  for (int row = 0; row < map.state.rows(); ++row)
    for (int column = 0; column < map.state.columns(); ++column) {
      if (!map.measured(row, column)) continue;
      ++measured;
      without_surface += count(row, column) == 0;
      if (count(row, column) > 0)
        squares += std::pow(map.elevation_m(row, column) - sum(row, column) / count(row, column), 2);
    }
  ASSERT_GT(measured, 2000);
  // a cell's mean of many returns is at least as good as the worst of them are on average (0.89 cm)
  EXPECT_LT(std::sqrt(squares / measured), 0.0089);
  // 27 444 sky pixels: what is left of them hangs on the ridge, within one cell of it or so
  EXPECT_LT(without_surface, measured / 100);
}

INSTANTIATE_TEST_SUITE_P(RealData, SyntheticPerceptron, testing::Bool(),
                         [](const auto& posed) { return posed.param ? "WithPose" : "Bare"; });

}  // namespace
}  // namespace scree::test
