// Every kind of input through the whole node, over ground that is known to be flat.

#include <cmath>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "drivers/perceptron_file.hpp"
#include "io/npy.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

struct Map {
  json facts;
  Grid<float> elevation_m;
  Grid<float> state;
};

/// Replays at full speed into `folder`/map.npy; the elevation of everything measured must be `height_m`.
Map replay_flat(const TemporaryFolder& folder, std::vector<std::string> arguments, double height_m,
                double tolerance_m = 1e-3) {
  arguments.insert(arguments.end(), {"--rate", "max", "--map-out", (folder / "map.npy").string()});
  const std::string recording = arguments.front();
  arguments.erase(arguments.begin());
  const auto finished = scree(replay(recording, arguments));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  if (finished.exit_code != 0) return {};
  Map map{json::parse(read_file(folder / "map.json")), *io::read_npy(folder / "map.elevation.npy"),
          *io::read_npy(folder / "map.cell_state.npy")};
  double worst_m = 0.0;
  for (std::size_t i = 0; i < map.state.size(); ++i)
    if (map.state[i] == 4.0f) worst_m = std::max(worst_m, std::abs(map.elevation_m[i] - height_m));
  EXPECT_LE(worst_m, tolerance_m);
  return map;
}

TEST(Formats, DepthImages) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 4));
  const Map map = replay_flat(folder, {recording.string()}, 0.0);
  EXPECT_EQ(map.facts["frames_mapped"], 4);
  EXPECT_EQ(map.facts["points"], 4 * 160 * 120);
  EXPECT_NEAR(map.facts["cells_measured"].get<double>(), 1200, 80) << "4 m × 3 m of 0.1 m cells";
}

TEST(Formats, CloudsOfARecording) {
  const TemporaryFolder folder;
  write_file(folder / "drive/recording.yaml",
             "scree_recording: 1\norigin: live\nsensor:\n  projection: cloud\n"
             "  T_body_sensor: {x_m: 0, y_m: 0, z_m: 1.5, qx: 0, qy: 0, qz: 0, qw: 1}\n");
  write_file(folder / "drive/frames/000000.bin", flat_cloud(-1.5f));
  write_file(folder / "drive/frames.csv", "file,t_s,sequence\n000000.bin,5,1\n");
  write_file(folder / "drive/poses.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n5,0,0,0,0,0,0,1\n");
  const Map map = replay_flat(folder, {(folder / "drive").string()}, 0.0);
  EXPECT_EQ(map.facts["cells_measured"], kFlatCloudCells);
  EXPECT_EQ(map.facts["points_fused"], 80 * 80);
}

TEST(Formats, KittiOdometry) {
  const TemporaryFolder folder;
  for (const char* scan : {"kitti/velodyne/000000.bin", "kitti/velodyne/000001.bin"})
    write_file(folder / scan, flat_cloud(-1.73f));
  write_file(folder / "kitti/times.txt", "0.000000e+00\n1.036000e-01\n");
  write_file(folder / "kitti/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  write_file(folder / "kitti/calib.txt", "P0: 7 0 6 0 0 7 1 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n");
  // the map's origin is the first camera, 8 cm below the scanner, 27 cm ahead
  const Map map = replay_flat(folder, {(folder / "kitti").string(), "--format", "kitti"}, -1.65);
  EXPECT_EQ(map.facts["frames_mapped"], 2);
  EXPECT_NEAR(map.facts["cells_measured"].get<double>(), kFlatCloudCells, 2 * 40 + 1) << "27 cm are no whole cells";
}

TEST(Formats, PcdDirectory) {
  const TemporaryFolder folder;
  std::string points;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) points += fmt::format("{} {} -1\n", 2.05 + 0.1 * i, -1.95 + 0.1 * j);
  write_file(folder / "pcd/a.pcd",
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1600\nHEIGHT 1\n"
             "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1600\nDATA ascii\n" +
                 points);
  write_file(folder / "pcd/poses.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n5,0,0,3,0,0,0,1\n");
  // ASCII: a build without PCL reads it too
  const Map map = replay_flat(folder, {(folder / "pcd").string(), "--format", "pcd"}, 2.0);
  EXPECT_EQ(map.facts["cells_measured"], 1600);
}

/// A bowl around the scanner that widens to the right and downwards: no pixel looks through another's surface, which
/// ground below passing rays would contradict.
Grid<std::uint16_t> bowl(int side) {
  Grid<std::uint16_t> raw(side, side);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      raw(row, column) = static_cast<std::uint16_t>(600 + column / 4 + row / 8);
  return raw;
}

std::string encoded(drivers::RangeFileLayout layout, int side) {
  drivers::RangeFile file;
  file.layout = layout;
  file.raw = bowl(side);
  const auto bytes = drivers::encode_range_file(file);
  EXPECT_TRUE(bytes);
  return {bytes->begin(), bytes->end()};
}

TEST(Formats, SingleUsfFile) {
  const TemporaryFolder folder;
  write_file(folder / "x.perc", encoded(drivers::RangeFileLayout::usf, 512));
  const auto finished = scree(replay((folder / "x.perc").string(), {"--rate", "max", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_EQ(statistics["frames_mapped"], 1);
  EXPECT_EQ(statistics["pixels"]["pixels"], 512 * 512);
  EXPECT_EQ(statistics["pixels"]["untrusted_row"], 4 * 512) << "the last four rows of a real image are not ranges";
  EXPECT_EQ(statistics["pixels"]["assumed_first_interval"], statistics["points"]) << "nothing says which interval";
  EXPECT_GT(statistics["cells_measured"], 0);
}

TEST(Formats, BothSizesOfCmuFilesGiveTheSameMap) {
  const TemporaryFolder folder;
  write_file(folder / "words.perc", encoded(drivers::RangeFileLayout::cmu_words, 256));
  write_file(folder / "ranges.perc", encoded(drivers::RangeFileLayout::cmu_ranges, 256));
  ASSERT_EQ(std::filesystem::file_size(folder / "words.perc"), 262144u);
  ASSERT_EQ(std::filesystem::file_size(folder / "ranges.perc"), 131072u);
  for (const char* name : {"words", "ranges"}) {
    const auto file = folder / (std::string(name) + ".perc");
    const auto out = folder / (std::string(name) + ".npy");
    const auto finished = scree(replay(file.string(), {"--rate", "max", "--map-out", out.string()}));
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
  }
  EXPECT_GT(json::parse(read_file(folder / "words.json"))["cells_measured"], 0);
  for (const char* layer : {"elevation", "cost", "cell_state"})
    EXPECT_EQ(read_file(folder / (std::string("words.") + layer + ".npy")) ==
                  read_file(folder / (std::string("ranges.") + layer + ".npy")),
              true)
        << layer;
}

}  // namespace
}  // namespace scree::test
