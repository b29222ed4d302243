// Where poses come from: the recording, a static one, POSE_INPUT datagrams.

#include <gmock/gmock.h>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <signal.h>
#include <thread>
#include <vector>

#include "io/npy.hpp"
#include "node/protocol.hpp"
#include "node/udp_socket.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using namespace node::protocol;  // the health bits

/// Says 50 times a second, from a thread of its own, that the robot stands at (3, 0, 0.5).
class PoseSender {
 public:
  explicit PoseSender(const std::string& address, const Key* key = nullptr)
      : key_(key),
        socket_(*node::UdpSocket::connect_to(*node::parse_endpoint(address, "test"), "test")),
        thread_([this](const std::stop_token& stop) {
          for (; !stop.stop_requested(); std::this_thread::sleep_for(milliseconds(20))) send();
        }) {}

  /// What was sent first, as somebody on the way might keep it.
  std::vector<Datagram> recorded() {
    const std::lock_guard lock(mutex_);
    return recorded_;
  }

 private:
  void send() {
    node::protocol::Header header;
    header.stream_id = 1;
    header.boot_id = kBoot;
    header.seq = ++seq_;
    node::protocol::PoseInputMessage message;
    message.time = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    message.T_map_body.translation_m = {3.0, 0.0, 0.5};
    node::protocol::Datagram datagram;
    encode(header, message, datagram, key_);
    if (seq_ == 5) datagram.bytes[70] ^= 1;  // one that must be refused
    const auto view = datagram.view();
    socket_.send(std::span(&view, 1));
    const std::lock_guard lock(mutex_);
    if (recorded_.size() < 20 && seq_ != 5) recorded_.push_back(datagram);
  }

  static constexpr std::uint64_t kBoot = 21;
  const Key* key_;
  std::mutex mutex_;
  std::vector<Datagram> recorded_;
  node::UdpSocket socket_;
  std::uint64_t seq_ = 0;
  std::jthread thread_;
};

TEST(PoseSource, UdpPosesPlaceTheFramesAndWithoutFreshOnesNothingIsMapped) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 5));
  std::filesystem::remove(recording / "poses.csv");  // nobody needs it
  Ear ear;
  Process node(live(live_config(folder / "robot.yaml", recording, "pose: {source: udp, max_age_ms: 300}\n"), ear,
                    {"--set", "source.loop=true", "--map-out", (folder / "map.npy").string()}));
  ASSERT_TRUE(node.wait_for_text("listening at")) << node.err();
  ASSERT_TRUE(ear.until_health(kHealthPoseStale, true)) << "no pose has come yet";
  EXPECT_EQ(ear->map(), nullptr) << "no map without a pose";

  std::optional<PoseSender> poses(listening_address(node.err()));
  ASSERT_TRUE(ear.until([&] { return ear.measured_cells() > 1000; })) << node.err();
  ASSERT_TRUE(ear.until_health(kHealthPoseStale, false));
  poses.reset();
  ASSERT_TRUE(ear.until_health(kHealthPoseStale, true));
  // a frame taken before waits up to max_age for its pose, and then still takes the newest: 0.6 s after that one
  const std::uint64_t at_first = ear->frames_in();
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= at_first + 8; }));
  const auto last_map = ear->last_valid_map();
  const std::uint64_t frames = ear->frames_in();
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= frames + 3; }));
  EXPECT_EQ(ear->last_valid_map()->revision, last_map->revision) << "frames come, the map stays as it is";

  node.signal(SIGINT);
  ASSERT_TRUE(ear.until_bye());
  const auto finished = node.wait(seconds(60));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_GE(statistics["frames_pose_stale"], 3);
  EXPECT_EQ(statistics["rejected"], 1);
  const json map = json::parse(read_file(folder / "map.json"));
  EXPECT_NEAR(map["x_min_m"].get<double>() + 0.05 * map["columns"].get<double>(), 3.0, 0.11);
  const auto elevation = io::read_npy(folder / "map.elevation.npy");
  ASSERT_TRUE(elevation);
  EXPECT_NEAR((*elevation)(100, 100), 0.5f, 1e-3f) << "flat ground at the body's z = 0";
}

// Whoever has no key, or another one, or a recording of what was sent, moves nothing; nor does a source that stopped.
TEST(PoseSource, ForgedReplayedAndForeignPosesAreCountedAndMapNothing) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 5));
  Key key{3, {}}, other{3, {}};
  key.bytes.fill(0x55);
  other.bytes.fill(0x66);
  Ear ear(key);
  Process node(
      live(live_config(folder / "robot.yaml", recording, "pose: {source: udp, max_age_ms: 300}\n"), ear,
           {"--set", "source.loop=true", "--set", "publish.keys=[{id: 3, hex: \"" + std::string(64, '5') + "\"}]"}));
  ASSERT_TRUE(node.wait_for_text("listening at")) << node.err();
  const std::string address = listening_address(node.err());

  std::vector<Datagram> kept;
  for (const Key* wrong : std::initializer_list<const Key*>{nullptr, &other}) {  // forged
    PoseSender sender(address, wrong);
    const std::uint64_t frames = ear->frames_in();
    ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= frames + 3; })) << node.err();
  }
  EXPECT_EQ(ear->map(), nullptr) << "nobody with the key said where the robot is";
  EXPECT_NE(ear->health() & kHealthPoseStale, 0);
  {
    PoseSender sender(address, &key);
    ASSERT_TRUE(ear.until([&] { return ear.measured_cells() > 1000; })) << node.err();
    ASSERT_TRUE(ear.until([&] { return sender.recorded().size() == 20; }));
    kept = sender.recorded();
  }
  ASSERT_TRUE(ear.until_health(kHealthPoseStale, true)) << "the source has stopped";
  const std::uint64_t at_first = ear->frames_in();
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= at_first + 8; }));
  const auto last_map = ear->last_valid_map();
  auto replaying = *node::UdpSocket::connect_to(*node::parse_endpoint(address, "test"), "test");
  for (const Datagram& datagram : kept) {
    const auto view = datagram.view();
    replaying.send(std::span(&view, 1));
  }
  const std::uint64_t frames = ear->frames_in();
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= frames + 5; }));
  EXPECT_EQ(ear->last_valid_map()->revision, last_map->revision);
  EXPECT_NE(ear->health() & kHealthPoseStale, 0) << "replayed poses are not fresh";

  node.signal(SIGINT);
  ASSERT_TRUE(ear.until_bye());
  const auto finished = node.wait(seconds(60));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json received = json::parse(finished.out)["received"];
  EXPECT_GT(received["poses_accepted"], 0);
  EXPECT_GE(received["poses_rejected"]["mac"], 10) << "two senders, 50 a second, for 3 frames of 0.1 s each";
  EXPECT_GE(received["poses_rejected"]["sequence"], kept.size());
}

TEST(PoseSource, StaticPosePlacesARecordingThatHasNone) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 3));
  std::filesystem::remove(recording / "poses.csv");
  EXPECT_EQ(scree(replay(recording.string(), {"--rate", "max"})).exit_code, 66) << "by default they are needed";

  write_file(folder / "robot.yaml",
             "pose:\n  source: static\n  T_map_body: {x_m: 7, y_m: -2, z_m: 1.25, qx: 0, qy: 0, qz: 0, qw: 1}\n");
  const auto finished = scree(replay(recording.string(), {"--rate", "max", "--config", (folder / "robot.yaml").string(),
                                                          "--map-out", (folder / "map.npy").string()}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json map = json::parse(read_file(folder / "map.json"));
  EXPECT_EQ(map["frames_mapped"], 3);
  EXPECT_NEAR(map["x_min_m"].get<double>(), 7.0 - 10.0, 0.051);
  EXPECT_NEAR(map["y_min_m"].get<double>(), -2.0 - 10.0, 0.051);
  const auto elevation = io::read_npy(folder / "map.elevation.npy");
  ASSERT_TRUE(elevation);
  EXPECT_NEAR((*elevation)(100, 100), 1.25f, 1e-3f);
}

TEST(PoseSource, UdpAtNoPaceIsAUsageError) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 3));
  const auto finished = scree(replay(recording.string(), {"--rate", "max", "--set", "pose.source=udp"}));
  EXPECT_EQ(finished.exit_code, 64);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("--rate max: expected a pace with pose.source udp"));
}

}  // namespace
}  // namespace scree::test
