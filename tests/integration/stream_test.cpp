// The simulated scanner as a live device: scree simulate --serve ⇄ scree run ⇄ a listener, with the real binary.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "drivers/drive_command.hpp"
#include "drivers/stream_server.hpp"
#include "drivers/table.hpp"
#include "io/npy.hpp"
#include "node/udp_socket.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using namespace node::protocol;  // the health bits

/// A drive of 2 m in 4 s, a frame every 2 s: slow enough for rendering and mapping under sanitizers.
const std::vector<std::string> kDrive{"--terrain",    "fbm:2.3,0.1,7,20,0.1", "--sensor",       "perceptron-cmu",
                                      "--trajectory", "line:-5,0,0,2,0.5",    "--frame-period", "2"};
constexpr int kDriveFrames = 3;

std::vector<std::string> simulate(std::vector<std::string> more, std::vector<std::string> drive = kDrive) {
  drive.insert(drive.begin(), "simulate");
  drive.insert(drive.end(), more.begin(), more.end());
  return command(std::move(drive));
}

class Stream : public ::testing::Test {
 protected:
  std::string address(const std::string& name = "scanner") const { return "unix:" + (folder_ / name).string(); }
  std::filesystem::path config(const std::string& stream_address, const std::string& more = {}) const {
    write_file(folder_ / "robot.yaml",
               fmt::format("source: {{kind: stream, address: \"{}\", deadline_ms: 60000}}\n{}", stream_address, more));
    return folder_ / "robot.yaml";
  }

  TemporaryFolder folder_;
  Ear ear_;
};

json stop(Process& node, Ear& ear) {
  node.signal(SIGINT);
  EXPECT_TRUE(ear.until_bye());
  const auto finished = node.wait(seconds(60));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return json::parse(finished.out, nullptr, false);
}

/// Every layer of both maps has the same bytes.
void expect_same_maps(const std::filesystem::path& folder, const std::string& a, const std::string& b) {
  int layers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(a + ".") || entry.path().extension() != ".npy") continue;
    const std::string layer = name.substr(a.size());
    EXPECT_EQ(read_file(entry.path()), read_file(folder / (b + layer))) << layer;
    ++layers;
  }
  EXPECT_GE(layers, 5);
}

// A frame of a stream is that of a recording to the last bit, and the mapper is deterministic: as long as no frame was
// late or dropped the tolerance between the two maps is zero. What a listener has differs by half a step of the wire.
TEST_F(Stream, AServedDriveGivesTheMapOfTheSameDriveRecorded) {
  ASSERT_EQ(run(simulate({"--out", (folder_ / "drive").string()})).exit_code, 0);
  const auto replayed =
      scree(replay((folder_ / "drive").string(), {"--rate", "max", "--map-out", (folder_ / "replayed.npy").string()}));
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;

  Process device(simulate({"--serve", address(), "--json"}));
  Process node(live(config(address()), ear_, {"--map-out", (folder_ / "live.npy").string()}));
  ASSERT_TRUE(ear_.until([&] {
    const auto map = ear_->last_valid_map();
    return map != nullptr && map->revision == kDriveFrames;  // all are mapped
  })) << node.err();
  const auto served = device.wait(seconds(60));
  ASSERT_EQ(served.exit_code, 0) << served.err;
  EXPECT_EQ(ear_->origin(), drivers::Origin::sim) << "the device says so, publish.origin is live";
  const json statistics = stop(node, ear_);

  const json report = json::parse(served.out);
  EXPECT_EQ(report["frames_rendered"], kDriveFrames);
  ASSERT_EQ(report["frames_late"], 0) << "this machine is too slow for the test";
  EXPECT_EQ(report["frames_sent"], kDriveFrames);
  EXPECT_NEAR(report["path_m"].get<double>(), 2.0, 0.05) << "along rough ground";
  EXPECT_EQ(statistics["frames_mapped"], kDriveFrames) << "of " << statistics;
  EXPECT_EQ(statistics["source"]["bytes_skipped"], 0);
  EXPECT_EQ(statistics["source"]["frames_missing"], 0);
  expect_same_maps(folder_.path(), "live", "replayed");

  const auto heard = ear_->last_valid_map();
  const auto elevation = io::read_npy(folder_ / "replayed.elevation.npy");
  ASSERT_TRUE(elevation);
  ASSERT_EQ(heard->elevation_m.size(), elevation->size());
  const double half_step_m = 0.5 * static_cast<double>(layer_format(Layer::elevation).scale);
  std::size_t known = 0;
  for (std::size_t i = 0; i < elevation->size(); ++i) {
    ASSERT_EQ(std::isnan(heard->elevation_m[i]), std::isnan((*elevation)[i])) << i;
    if (std::isnan((*elevation)[i])) continue;
    // heights are rounded to the step and then to float
    ASSERT_NEAR(heard->elevation_m[i], (*elevation)[i], half_step_m + 1e-6) << i;
    ++known;
  }
  EXPECT_GT(known, 1000u);
}

TEST_F(Stream, AKilledDeviceIsLostAndFramesComeAgainFromTheNextOne) {
  const std::vector<std::string> lidar{"--terrain",       "fbm:2.3,0.1,7,20,0.1", "--sensor", "lidar64", "--trajectory",
                                       "line:-2,0,0,0,1", "--frame-period",       "0.5",      "--drive", "127.0.0.1:0"};
  std::optional<Process> device(std::in_place, simulate({"--serve", address()}, lidar));
  Process node(
      live(config(address()), ear_, {"--set", "node.sensor_stale_ms=1500", "--set", "node.sensor_lost_ms=2500"}));
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() >= 2; })) << node.err();
  EXPECT_EQ(ear_->health() & kHealthSensorLost, 0);
  device->signal(SIGKILL);
  device->wait();
  ASSERT_TRUE(ear_.until_health(kHealthSensorLost, true)) << node.err();
  const auto frames = ear_->frames_in();
  device.emplace(simulate({"--serve", address()}, lidar));  // over the socket that the dead one left behind
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() >= frames + 2; })) << node.err() << device->err();
  ASSERT_TRUE(ear_.until_health(kHealthSensorLost, false));
  const json statistics = stop(node, ear_);
  EXPECT_EQ(statistics["source"]["connections"], 2);
  EXPECT_THAT(node.err(), ::testing::HasSubstr("the other end has closed the connection; connecting again"));
}

/// Between device and node: hands on every byte, but changes or drops some.
class BadCable {
 public:
  BadCable(const std::string& from, const std::string& to) : from_(*drivers::parse_stream_address(from, "test")) {
    auto opened = drivers::StreamSocket::listen_at(*drivers::parse_stream_address(to, "test"));
    EXPECT_TRUE(opened) << opened.error().message;
    listener_.emplace(*std::move(opened));
    thread_ = std::jthread([this](const std::stop_token& stop) { carry(stop); });
  }

 private:
  void carry(const std::stop_token& stop) {
    std::optional<drivers::StreamSocket> reader, device;
    while (!stop.stop_requested() && !reader) {
      reader = listener_->accept();
      std::this_thread::sleep_for(milliseconds(5));
    }
    while (!stop.stop_requested() && !device) {
      auto connected = drivers::StreamSocket::connect_to(from_, milliseconds(100));
      if (connected) device = *std::move(connected);
      std::this_thread::sleep_for(milliseconds(5));
    }
    std::vector<std::uint8_t> bytes(1 << 16);
    std::uint64_t carried = 0;
    while (!stop.stop_requested()) {
      const auto moved = device->read(bytes, milliseconds(10));
      auto piece = std::span(bytes).first(moved.bytes);
      spoil(piece, carried);
      carried += moved.bytes;
      while (!piece.empty() && !stop.stop_requested()) piece = piece.subspan(reader->write(piece).bytes);
      if (moved.closed) return;
    }
  }
  /// One byte of the words of frames 1 and 3 (from 0), and of the header of frame 5's GEOMETRY.
  void spoil(std::span<std::uint8_t> piece, std::uint64_t carried) const {
    for (const std::uint64_t at : {1 * kFrame + 50'000, 3 * kFrame + 90'000, 5 * kFrame + 20})
      if (at >= carried && at < carried + piece.size()) piece[at - carried] ^= 0x5A;
  }

 public:
  /// GEOMETRY and FRAME of lidar64: 64 rows, 1024 columns, taken at the very time of one pose.
  static constexpr std::uint64_t kFrame = (48 + 248 + 8 * (64 + 1024)) + (48 + 32 + 8 * 64 + 64 + 2 * 64 * 1024);

 private:
  drivers::StreamAddress from_;
  std::optional<drivers::StreamSocket> listener_;
  std::jthread thread_;
};

TEST_F(Stream, DamageOnTheWayIsCountedAndCostsOnlyTheFramesItHits) {
  const std::vector<std::string> lidar{"--terrain",    "fbm:2.3,0.1,7,20,0.1", "--sensor",       "lidar64",
                                       "--trajectory", "line:-2,0,0,0.7,0.1",  "--frame-period", "1"};
  Process device(simulate({"--serve", address("device"), "--json"}, lidar));
  ASSERT_TRUE(device.wait_for_text("serving")) << device.err();
  const BadCable cable(address("device"), address("node"));
  Process node(live(config(address("node")), ear_));
  const auto served = device.wait(seconds(120));
  ASSERT_EQ(served.exit_code, 0) << served.err;
  const json report = json::parse(served.out);
  ASSERT_EQ(report["frames_late"], 0) << "this machine is too slow for the test";
  EXPECT_EQ(report["frames_sent"], 8);
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() >= 6; })) << node.err();
  const json statistics = stop(node, ear_);
  EXPECT_EQ(statistics["frames_in"], 6);
  EXPECT_EQ(statistics["frames_skipped"], 2) << "the frames that were hit";
  const json& source = statistics["source"];
  EXPECT_EQ(source["payload_crc"], 2);
  EXPECT_EQ(source["header_crc"], 1);
  EXPECT_EQ(source["frames_missing"], 2);
  EXPECT_EQ(source["messages"], 16 - 3);
  const std::uint64_t geometry = 48 + 248 + 8 * (64 + 1024);
  EXPECT_EQ(source["bytes_skipped"], 2 * (BadCable::kFrame - geometry) + geometry) << "two FRAMEs and a GEOMETRY";
}

TEST_F(Stream, ADeviceThatIsNotTheConfiguredOneEndsTheNodeWith78) {
  Process device(simulate({"--serve", address()}));
  Process node(
      live(config(address(), "sensor: {projection: perceptron_cmu, parameters: {rows: 512, columns: 512}}\n"), ear_));
  const auto finished = node.wait(seconds(60));
  EXPECT_EQ(finished.exit_code, 78);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("sensor.parameters.rows: expected 512, as configured, found a device "
                                                 "that says 256"));
}

TEST_F(Stream, ADrivenRobotObeysCommandsAndReportsItsWayOverTheTrueGround) {
  const std::string track = (folder_ / "track.csv").string();
  Process device(simulate(
      {"--serve", "tcp:0", "--drive", "127.0.0.1:0", "--track", track, "--json", "--set", "vehicle.max_step_m=0.01"}));
  ASSERT_TRUE(device.wait_for_text("driven at 127.0.0.1:")) << device.err();
  const std::string log = device.err();
  const auto behind = [&](const std::string& mark) {
    const auto begin = log.find(mark) + mark.size();
    return log.substr(begin, log.find('\n', begin) - begin);
  };
  auto pilot = *node::UdpSocket::connect_to(*node::parse_endpoint(behind("driven at "), "test"), "test");
  const auto say = [&](std::uint64_t sequence, float speed_mps) {
    std::array<std::uint8_t, drivers::kDriveBytes> bytes{};
    drivers::encode_drive({11, sequence, speed_mps, 0.2F}, bytes);
    const std::span<const std::uint8_t> view(bytes);
    pilot.send(std::span(&view, 1));
  };
  Process node(live(config(behind("at ")), ear_));  // "serving perceptron-cmu at tcp:…"
  std::uint64_t sequence = 0;
  ASSERT_TRUE(ear_.until([&] {
    say(++sequence, 0.5F);
    return ear_->frames_in() >= 2;
  })) << node.err();
  say(1, 0.5F);                                     // an old one
  std::this_thread::sleep_for(milliseconds(1500));  // the command runs out
  (void)stop(node, ear_);
  device.signal(SIGINT);
  const auto served = device.wait(seconds(60));
  ASSERT_EQ(served.exit_code, 0) << served.err;
  const json report = json::parse(served.out);
  EXPECT_GT(report["path_m"], 0.5);
  EXPECT_LE(report["path_m"].get<double>(), 0.5 * report["duration_s"].get<double>() * 1.05);
  EXPECT_EQ(report["drive"]["rejected"], 1);
  EXPECT_EQ(report["drive"]["timeouts"], 1);
  EXPECT_GT(report["step_max_m"], 0.01);
  EXPECT_GT(report["violated_m"], 0.1) << "of a limit that rough ground must break";
  EXPECT_GT(report["pitch_max_rad"], 0.0);
  const auto poses = drivers::parse_poses_table(read_file(track), track);
  ASSERT_TRUE(poses) << poses.error().message;
  EXPECT_NEAR(static_cast<double>(poses->size()), 100.0 * report["duration_s"].get<double>(), 5.0);
  EXPECT_NEAR(poses->front().T_map_body.translation_m.x(), -5.0, 1e-12);
}

TEST_F(Stream, PosesThatTheDeviceSendsPlaceTheFramesOfANodeThatTakesThemByUdp) {
  Process node(live(config(address(), "pose: {source: udp, max_age_ms: 2000}\n"), ear_));
  ASSERT_TRUE(node.wait_for_text("listening at ")) << node.err();
  const std::string log = node.err(), mark = "listening at ";
  const std::string listen =
      log.substr(log.find(mark) + mark.size(), log.find('\n', log.find(mark)) - log.find(mark) - mark.size());
  Process device(simulate({"--serve", address(), "--pose-out", listen, "--json"}));
  const auto served = device.wait(seconds(60));
  ASSERT_EQ(served.exit_code, 0) << served.err;
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() == kDriveFrames && ear_.measured_cells() > 1000; }))
      << node.err();
  const json statistics = stop(node, ear_);
  EXPECT_GT(json::parse(served.out)["poses_sent"], 50);
  EXPECT_EQ(statistics["frames_mapped"], kDriveFrames);
  EXPECT_EQ(statistics["rejected"], 0);
}

TEST_F(Stream, WrongOptionsAreUsageErrorsAndATakenAddressIs69) {
  EXPECT_EQ(run(simulate({})).exit_code, 64);
  EXPECT_EQ(run(simulate({"--out", (folder_ / "a").string(), "--serve", address()})).exit_code, 64);
  EXPECT_EQ(run(simulate({"--out", (folder_ / "a").string(), "--drive", "127.0.0.1:0"})).exit_code, 64);
  EXPECT_EQ(run(simulate({"--serve", "tcp:192.168.0.1:80"})).exit_code, 64);
  EXPECT_EQ(run(simulate({"--serve", address(), "--track", "/nowhere/track.csv"})).exit_code, 73);
  Process first(simulate({"--serve", address()}));
  ASSERT_TRUE(first.wait_for_text("serving"));
  const auto second = run(simulate({"--serve", address()}));
  EXPECT_EQ(second.exit_code, 69);
  EXPECT_THAT(second.err, ::testing::HasSubstr("expected a free address"));
}

}  // namespace
}  // namespace scree::test
