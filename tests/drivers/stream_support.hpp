#pragma once
// What the tests of the frame stream share: a small scanner, and a stream taken apart.

#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/frame_stream.hpp"
#include "drivers/stream_frame_reader.hpp"

namespace scree::drivers::stream {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::uint64_t kTestBoot = 0x0123456789ABCDEF;
inline const Time kTestTime{std::chrono::seconds(1'700'000'000)};

/// Reads tests/drivers/golden/NAME.hex: comment lines begin with '#', the rest is bytes in hexadecimal.
inline Bytes golden_stream(const std::string& name) {
  std::ifstream file(std::string(SCREE_SOURCE_DIR) + "/tests/drivers/golden/" + name + ".hex");
  Bytes bytes;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

/// The 3 × 4 scanner of the golden vectors.
inline Geometry test_scanner() {
  Geometry geometry;
  geometry.device = "test scanner";
  geometry.word_bytes = 4;
  SensorConfig& sensor = geometry.sensor;
  sensor.projection.kind = ProjectionKind::perceptron_cmu;
  sensor.projection.reflectance_shift = 16;
  sensor.projection.invalid_raw = 0;
  sensor.projection.field_of_view_rad = {1.0, 0.75};
  sensor.projection = *complete_projection(sensor.projection, 3, 4);
  sensor.T_body_sensor = {{0.25, 0.0, 1.5}, Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5)};
  sensor.row_period = std::chrono::milliseconds(1);
  sensor.noise = {0.01, 0.001, 0.0001, 0.0};
  sensor.filter.range_min_m = 0.5;
  sensor.filter.range_max_m = 60.0;
  return geometry;
}

/// The contents of a frame, owned; `raw` 3 × 4.
struct TestFrame {
  std::uint64_t sequence = 0;
  std::vector<Time> row_time;
  std::vector<StampedPose> poses;
  PoseVariance variance{{0.25, 0.25, 0.5}, {0.0, 0.0, 0.0625}};
  Grid<std::uint16_t> raw{3, 4}, reflectance{3, 4};

  OutgoingFrame view() const { return {sequence, row_time, poses, variance, raw, reflectance}; }
};

/// The frame of the golden vectors, half a second of time for each number; `salt` makes others of it.
inline TestFrame test_frame(std::uint64_t sequence, int salt = 0) {
  using std::chrono::milliseconds;
  TestFrame frame;
  frame.sequence = sequence;
  const Time t = kTestTime + static_cast<std::int64_t>(sequence) * milliseconds(500);
  frame.row_time = {t, t + milliseconds(1), t + milliseconds(2)};
  frame.poses = {{t - milliseconds(1), {{1.0, 2.0, 0.5}, Eigen::Quaterniond::Identity()}},
                 {t + milliseconds(9), {{1.5, 2.0, 0.5}, {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}}}};
  for (int i = 0; i < 12; ++i) {
    frame.raw[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>((300 * i + 5 + 17 * salt) % 4096);
    frame.reflectance[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(4095 - 7 * i);
  }
  return frame;
}

inline Bytes encoded(const Encoder& encoder, const TestFrame& frame) {
  Bytes out;
  const auto done = encoder.encode(frame.view(), out);
  EXPECT_TRUE(done) << (done ? "" : done.error().message);
  return out;
}

inline Encoder test_encoder() {
  auto encoder = Encoder::make(test_scanner(), kTestBoot, true);
  EXPECT_TRUE(encoder) << (encoder ? "" : encoder.error().message);
  return *std::move(encoder);
}

inline Result<SensorConfig> as_told(const SensorConfig& told) {
  return told;
}

/// A decoder and a reader, and all that came out of them.
struct Ears {
  Decoder decoder;
  FrameReader reader{as_told, true};
  std::vector<RangeFrame> frames;
  std::vector<Taken> taken;
  std::uint64_t message_bytes = 0;

  void hear(std::span<const std::uint8_t> bytes) {
    while (const auto message = decoder.next(bytes)) {
      message_bytes += kHeaderBytes + message->payload.size();
      RangeFrame frame;
      const auto what = reader.take(*message, frame);
      ASSERT_TRUE(what) << what.error().message;
      taken.push_back(*what);
      if (*what == Taken::frame) frames.push_back(std::move(frame));
    }
    const DecoderCounters& counters = decoder.counters();
    EXPECT_EQ(counters.bytes, message_bytes + counters.bytes_skipped + decoder.held());
  }
  void hear_in_pieces(std::span<const std::uint8_t> bytes, std::size_t piece) {
    for (; !bytes.empty(); bytes = bytes.subspan(std::min(piece, bytes.size())))
      hear(bytes.first(std::min(piece, bytes.size())));
  }
  std::vector<std::uint64_t> sequences() const {
    std::vector<std::uint64_t> out;
    for (const RangeFrame& frame : frames) out.push_back(frame.sequence);
    return out;
  }
};

/// Equal to the last bit, but for NaN, which is equal to itself here.
inline bool same_bits(const Grid<float>& a, const Grid<float>& b) {
  return a.rows() == b.rows() && a.columns() == b.columns() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

}  // namespace scree::drivers::stream
