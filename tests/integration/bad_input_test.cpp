// Each bad input gives one clear message and the exit code of its kind.

#include <gmock/gmock.h>

#include "io/picture.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;

TEST(BadInput, UsageIs64) {
  EXPECT_EQ(scree({}).exit_code, 64);
  EXPECT_EQ(scree({"fly"}).exit_code, 64);
  EXPECT_EQ(scree({"replay"}).exit_code, 64);
  EXPECT_EQ(scree({"replay", "x", "--rate", "0"}).exit_code, 64);
  EXPECT_EQ(scree({"listen", "--accept", "dog"}).exit_code, 64);
  EXPECT_EQ(scree({"--help"}).exit_code, 0);
  EXPECT_EQ(scree({"--version"}).exit_code, 0);
}

TEST(BadInput, MissingInputsAre66) {
  const auto nothing = scree(replay("/nowhere/drive"));
  EXPECT_EQ(nothing.exit_code, 66);
  EXPECT_THAT(nothing.err, HasSubstr("/nowhere/drive: expected a recording"));

  const TemporaryFolder folder;
  const auto copy = copy_of_recording(folder);
  std::filesystem::remove(copy / "recording.yaml");
  const auto no_yaml = scree(replay(copy.string()));
  EXPECT_EQ(no_yaml.exit_code, 66);
  EXPECT_THAT(no_yaml.err, HasSubstr("recording.yaml: expected the description of a recording"));
}

TEST(BadInput, FaultyRecordingDescriptionIs65WithItsPosition) {
  const TemporaryFolder folder;
  const auto copy = copy_of_recording(folder);
  write_file(copy / "recording.yaml", "scree_recording: 1\nsensor:\n  projection: sonar\n");
  const auto finished = scree(replay(copy.string()));
  EXPECT_EQ(finished.exit_code, 65);
  EXPECT_THAT(finished.err, HasSubstr("recording.yaml:3:15: sensor.projection: expected one of perceptron_usf"));
  EXPECT_THAT(finished.err, HasSubstr("sensor.T_body_sensor.qw"));
}

TEST(BadInput, ConfigurationFaultsAre78AllAtOnce) {
  const TemporaryFolder folder;
  write_file(folder / "robot.yaml", "map:\n  cel_m: 0.1\nnode:\n  threads: many\n");
  const auto finished = scree(replay(small_recording().string(), {"--config", (folder / "robot.yaml").string()}));
  EXPECT_EQ(finished.exit_code, 78);
  EXPECT_THAT(finished.err, HasSubstr("robot.yaml:2:3: map.cel_m: expected a known key (nearest: map.cell_m)"));
  EXPECT_THAT(finished.err, HasSubstr("robot.yaml:4:12: node.threads: expected an integer from 1 to 64, found 'many'"));
}

TEST(BadInput, UnwritableOutputIs73BeforeTheWork) {
  const auto maps = scree(replay("/nowhere/drive", {"--map-out", "/nowhere/map.npy"}));
  EXPECT_EQ(maps.exit_code, 73) << maps.err;  // said before the recording is even looked for
  const auto picture = scree(replay("/nowhere/drive", {"--snapshot", "/nowhere/map.png"}));
  EXPECT_EQ(picture.exit_code, io::picture_support() ? 73 : 64) << picture.err;
  const auto simulated = scree({"simulate", "--terrain", "fbm:2.3,0.1,7,10,0.1", "--sensor", "depth", "--trajectory",
                                "line:-2,0,0,1,1", "--out", "/dev/null/drive"});
  EXPECT_EQ(simulated.exit_code, 73) << simulated.err;
}

TEST(BadInput, FaultScriptsAreJudgedBeforeTheDeviceServes) {
  const TemporaryFolder folder;
  const auto serve = [&](const std::string& script) {
    write_file(folder / "faults.txt", script);
    return scree({"simulate", "--terrain", "fbm:2.3,0.1,7,10,0.1", "--sensor", "depth-small", "--trajectory",
                  "line:-2,0,0,1,1", "--serve", "unix:" + (folder / "s").string(), "--faults",
                  (folder / "faults.txt").string()});
  };
  const auto unknown = serve("# none\n1 explode\n");
  EXPECT_EQ(unknown.exit_code, 65);
  EXPECT_THAT(unknown.err, HasSubstr("faults.txt:2: expected one of unplug, stall"));
  const auto endpoint = serve("1 unplug 1\n2 babble\n");
  EXPECT_EQ(endpoint.exit_code, 64);
  EXPECT_THAT(endpoint.err, HasSubstr("faults.txt:2: expected faults of a socket, found 'babble'"));
  const auto recording =
      scree({"simulate", "--terrain", "fbm:2.3,0.1,7,10,0.1", "--sensor", "depth-small", "--trajectory",
             "line:-2,0,0,1,1", "--out", (folder / "out").string(), "--faults", "x"});
  EXPECT_EQ(recording.exit_code, 64) << "a recording has no faults";
}

TEST(BadInput, AddressesToServeAtAreNamedAsTheyWereGiven) {
  const auto serve = [](const std::string& address) {
    return scree({"simulate", "--terrain", "fbm:2.3,0.1,7,10,0.1", "--sensor", "depth-small", "--trajectory",
                  "line:-2,0,0,1,1", "--serve", address});
  };
  const auto unknown = serve("udp:47810");
  EXPECT_EQ(unknown.exit_code, 64);
  EXPECT_THAT(unknown.err, HasSubstr("--serve: expected unix:PATH or tcp:[HOST:]PORT with a HOST of this machine"));
  EXPECT_THAT(unknown.err, HasSubstr("found 'udp:47810'"));
  const auto no_path = serve("unix:");
  EXPECT_EQ(no_path.exit_code, 64);
  EXPECT_THAT(no_path.err, HasSubstr("bytes behind unix:, found 'unix:'"));
  const auto no_port = serve("usbredir:");
  EXPECT_EQ(no_port.exit_code, 64);
#ifdef SCREE_WITH_USBREDIR
  EXPECT_THAT(unknown.err, HasSubstr("or usbredir:PATH"));
  EXPECT_THAT(no_port.err, HasSubstr("bytes behind usbredir:, found 'usbredir:'"));
#else
  EXPECT_THAT(no_port.err, HasSubstr("in a build without SCREE_WITH_USBREDIR, found 'usbredir:'"));
#endif
}

TEST(BadInput, OccupiedPortsAre69) {
  Process first(command({"listen", "--address", address(1)}));
  ASSERT_TRUE(first.wait_for_text("listening at")) << first.err();
  const auto second = scree({"listen", "--address", address(1)});
  EXPECT_EQ(second.exit_code, 69);
  EXPECT_THAT(second.err, HasSubstr(address(1)));
  const auto node = scree(replay(small_recording().string(), {"--set", "publish.listen=" + address(1)}));
  EXPECT_EQ(node.exit_code, 69);
  EXPECT_THAT(node.err, HasSubstr(address(1)));
}

TEST(BadInput, OneBadFrameIsSkippedAndCounted) {
  const TemporaryFolder folder;
  const auto copy = copy_of_recording(folder);
  const auto frame = std::filesystem::directory_iterator(copy / "frames")->path();
  std::filesystem::resize_file(frame, 1000);
  const auto finished = scree(replay(copy.string(), {"--rate", "max", "--json"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr(frame.filename().string()));
  EXPECT_THAT(finished.out, HasSubstr("\"frames_skipped\": 1"));
}

TEST(BadInput, RecordingWithoutOneGoodFrameIs65) {
  const TemporaryFolder folder;
  const auto copy = copy_of_recording(folder);
  for (const auto& entry : std::filesystem::directory_iterator(copy / "frames"))
    std::filesystem::resize_file(entry.path(), 1000);
  EXPECT_EQ(scree(replay(copy.string(), {"--rate", "max"})).exit_code, 65);
}

TEST(BadInput, PosesThatCoverNothingOrAreNotFiniteAre65) {
  const TemporaryFolder folder;
  const auto copy = copy_of_recording(folder);
  const std::string header = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const char* rows : {"", "900,0,0,0,0,0,0,1\n901,0,0,0,0,0,0,1\n", "0,nan,0,0,0,0,0,1\n9,0,0,0,0,0,0,1\n",
                           "100,0,0,0,0,0,0,1\n", "-1000,0,0,0,0,0,0,1\n1000,5,0,0,0,0,0,1\n"}) {
    write_file(copy / "poses.csv", header + rows);
    const auto finished = scree(replay(copy.string(), {"--rate", "max"}));
    EXPECT_EQ(finished.exit_code, 65) << rows << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("expected")) << rows;
  }
}

TEST(BadInput, BadRangeFilesAre65) {
  const TemporaryFolder folder;
  const auto file = folder / "x.perc";
  for (const std::string& bytes : {std::string(), std::string("garbage\n"), std::string(262143, 'x'),
                                   std::string("rows: 0\ncolumns: 512\n"), std::string(262145, '\n')}) {
    write_file(file, bytes);
    const auto finished = scree(replay(file.string(), {"--rate", "max"}));
    EXPECT_EQ(finished.exit_code, 65) << bytes.size() << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("x.perc"));
  }
}

}  // namespace
}  // namespace scree::test
