#pragma once
// Recordings made by hand for the tests of what reads them.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {

using testing::HasSubstr;
using namespace std::chrono_literals;
using Kind = SourceEvent::Kind;

constexpr const char* kPoses = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";

inline SensorConfig depth_camera() {
  SensorConfig sensor;
  auto& projection = sensor.projection;
  projection.kind = ProjectionKind::pinhole;
  projection.fx_px = projection.fy_px = 2.0;
  projection.cx_px = 1.0;
  projection.cy_px = 0.5;
  return sensor;
}

inline SensorConfig of_kind(ProjectionKind kind) {
  SensorConfig sensor;
  sensor.projection.kind = kind;
  return sensor;
}

inline SensorConfig cmu_scanner(Duration row_period) {
  SensorConfig sensor;
  sensor.projection.kind = ProjectionKind::perceptron_cmu;
  sensor.row_period = row_period;
  return sensor;
}

inline Time at(double t_s) {
  return Time(from_seconds(t_s));
}

/// What a source delivered until its end.
struct Delivered {
  std::vector<std::shared_ptr<const RangeFrame>> frames;
  std::vector<std::string> skipped;
  std::optional<Error> error;
};

inline Delivered drain(Source& source) {
  Delivered delivered;
  for (;;) {
    const auto event = source.next(0ms);
    if (!event) {
      delivered.error = event.error();
      return delivered;
    }
    if (event->kind == Kind::end_of_stream) return delivered;
    if (event->kind == Kind::frame) delivered.frames.push_back(event->frame);
    if (event->kind == Kind::skipped) delivered.skipped.push_back(event->message);
  }
}

class RecordingTest : public testing::Test {
 protected:
  std::filesystem::path root() const { return directory_.path() / "recording"; }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root() / name).parent_path());
    std::ofstream(root() / name, std::ios::binary) << text;
  }

  /// A recording of 2 × 3 depth images at 0, 1, 2 s, driven along x at 1 m/s; poses at 0, 1, … 10 s.
  void write_depth_recording(int frames) const {
    auto writer = RecordingWriter::create(root(), "scree_recording: 1\n");
    ASSERT_TRUE(writer) << writer.error().message;
    Grid<std::uint16_t> raw(2, 3, 1000);
    raw(0, 0) = 0;
    for (int i = 0; i < frames; ++i)
      ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::pinhole, raw, at(i), static_cast<std::uint64_t>(i)));
    for (int i = 0; i <= 10; ++i)
      ASSERT_TRUE(writer->add_pose({at(i), {{1.0 * i, 0.0, 0.0}, Eigen::Quaterniond::Identity()}}));
    ASSERT_TRUE(writer->finish());
  }

  Result<std::unique_ptr<Source>> open(SensorConfig sensor = depth_camera(), ReplayWindow window = {}) const {
    return open_recording(root(), {Origin::sim, std::move(sensor)}, window);
  }

  Error open_error(SensorConfig sensor = depth_camera()) const {
    const auto source = open(std::move(sensor));
    return source ? Error{ErrorKind::internal, "accepted"} : source.error();
  }

  test::TemporaryFolder directory_;
};

}  // namespace scree::drivers
