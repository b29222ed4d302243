// What a reader makes of messages whose CRCs are right.

#include <gmock/gmock.h>

#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"
#include "tests/drivers/simulator_support.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::drivers::stream {
namespace {

using std::chrono::milliseconds;

/// A message of any payload, sealed.
Bytes sealed(MessageType type, const Bytes& payload, std::uint32_t geometry_id, std::uint64_t sequence = 0,
             std::uint8_t minor = 0) {
  Header header;
  header.type = type;
  header.version_minor = minor;
  header.boot_id = kTestBoot;
  header.sequence = sequence;
  header.geometry_id = geometry_id;
  header.payload_bytes = static_cast<std::uint32_t>(payload.size());
  header.payload_crc = crc32_of(payload);
  Bytes out(kHeaderBytes);
  write_header(header, out);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

Bytes scanner_geometry() {
  return encode_geometry(test_scanner());
}

Bytes frame_payload(const TestFrame& frame) {
  const Bytes bytes = encoded(test_encoder(), frame);
  const std::size_t frame_at = kHeaderBytes + kGeometryBytes + kHeaderBytes;
  return {bytes.begin() + static_cast<std::ptrdiff_t>(frame_at), bytes.end()};
}

/// What becomes of a frame whose payload was changed by hand, behind its geometry.
struct Judged {
  Taken taken = Taken::frame;
  std::string reason;
};
Judged judge(const Bytes& payload, std::uint8_t minor = 0) {
  Ears ears;
  const Bytes geometry = scanner_geometry();
  ears.hear(sealed(MessageType::geometry, geometry, crc32_of(geometry)));
  ears.hear(sealed(MessageType::frame, payload, crc32_of(geometry), 0, minor));
  EXPECT_EQ(ears.taken.size(), 2u);
  return {ears.taken.back(), ears.reader.reason()};
}

template <class T>
Bytes with(Bytes payload, std::size_t offset, T value) {
  ByteWriter(std::span(payload).subspan(offset)).put(value);
  return payload;
}

TEST(StreamFrameReader, FieldsThatContradictTheTablesAreNamed) {
  const Bytes good = frame_payload(test_frame(0));
  EXPECT_EQ(judge(good).taken, Taken::frame);
  const std::size_t second_pose = kFrameBytes + 3 * 8 + kPoseBytes;
  const struct {
    Bytes payload;
    Taken taken;
    const char* reason;
  } cases[] = {
      {with<std::uint16_t>(good, 0, 4), Taken::bad_frame, "image: expected 3 x 4 words of 4 bytes, found 4 x 4 of 4"},
      {with<std::uint16_t>(good, 6, 3), Taken::bad_frame, "payload: expected"},
      {with<std::uint16_t>(good, 6, 4097), Taken::bad_frame, "poses: expected at most 4096"},
      {with<float>(good, 8, -1.0F), Taken::bad_frame, "variance"},
      {with<float>(good, 28, std::nanf("")), Taken::bad_frame, "variance"},
      {with<std::int64_t>(good, 40, 0), Taken::bad_frame, "row times"},
      {with<std::int64_t>(good, 32, INT64_MIN), Taken::bad_frame, "row times"},
      {with<std::int64_t>(good, second_pose, 0), Taken::bad_frame, "pose times"},
      {with<double>(good, second_pose + 8, 1e9), Taken::bad_frame, "pose: expected metres"},
      {with<double>(good, second_pose + 16, std::nan("")), Taken::bad_frame, "pose: expected metres"},
      {with<double>(good, second_pose + 56, 0.0), Taken::bad_frame,
       "pose: expected metres within 1e8 and a quaternion"},
  };
  for (const auto& item : cases) {
    const Judged judged = judge(item.payload);
    EXPECT_EQ(judged.taken, item.taken) << item.reason;
    EXPECT_THAT(judged.reason, ::testing::HasSubstr(item.reason));
  }
}

TEST(StreamFrameReader, BytesBehindTheBodyPassInLaterMinorVersionsOnly) {
  Bytes longer = frame_payload(test_frame(0));
  longer.resize(longer.size() + 5);
  EXPECT_EQ(judge(longer).taken, Taken::bad_frame);
  EXPECT_EQ(judge(longer, 1).taken, Taken::frame);
}

TEST(StreamFrameReader, AFrameNeedsAPoseForEveryRowUnlessPosesComeFromElsewhere) {
  TestFrame late = test_frame(0), none = test_frame(0), apart = test_frame(0), still = test_frame(0);
  late.poses[0].time = late.row_time[0] + milliseconds(1);
  none.poses.clear();
  apart.poses[0].time -= std::chrono::seconds(1);
  still.poses[0].time -= std::chrono::seconds(100);
  still.poses[1].T_map_body = still.poses[0].T_map_body;
  EXPECT_EQ(judge(frame_payload(late)).taken, Taken::no_pose);
  EXPECT_THAT(judge(frame_payload(none)).reason, ::testing::HasSubstr("pose.source udp or static"));
  EXPECT_EQ(judge(frame_payload(apart)).taken, Taken::no_pose);
  EXPECT_EQ(judge(frame_payload(still)).taken, Taken::frame) << "equal poses are a body that stood";
  Ears ears;
  ears.reader = FrameReader(as_told, false);
  ears.hear(encoded(test_encoder(), none));
  ASSERT_EQ(ears.frames.size(), 1u);
  EXPECT_EQ(ears.frames[0].T_map_body.size(), 3u);
}

TEST(StreamFrameReader, RowsGetThePosesThatAPoseTrackGives) {
  TestFrame frame = test_frame(0);
  frame.row_time[1] = frame.poses[0].time + milliseconds(3);  // between, and exactly at, poses
  frame.poses.insert(frame.poses.begin() + 1, {frame.row_time[1], {{1.2, 2.5, 0.5}, Eigen::Quaterniond::Identity()}});
  frame.row_time[2] = frame.poses[2].time;
  Ears ears;
  ears.hear(encoded(test_encoder(), frame));
  ASSERT_EQ(ears.frames.size(), 1u);
  const auto track = PoseTrack::make(frame.poses);
  ASSERT_TRUE(track);
  for (std::size_t r = 0; r < 3; ++r) {
    const Pose expected = *track->at(frame.row_time[r]);
    EXPECT_EQ(ears.frames[0].T_map_body[r].translation_m, expected.translation_m) << r;
    EXPECT_EQ(ears.frames[0].T_map_body[r].rotation.coeffs(), expected.rotation.coeffs()) << r;
  }
}

TEST(StreamFrameReader, AFrameOfAnUnknownGeometryWaitsForItsGeometry) {
  const Bytes geometry = scanner_geometry(), payload = frame_payload(test_frame(0));
  Ears ears;
  ears.hear(sealed(MessageType::frame, payload, crc32_of(geometry)));
  EXPECT_EQ(ears.taken.back(), Taken::no_geometry);
  ears.hear(sealed(MessageType::geometry, geometry, crc32_of(geometry)));
  ears.hear(sealed(MessageType::frame, payload, crc32_of(geometry) ^ 1));
  EXPECT_EQ(ears.taken.back(), Taken::no_geometry);
  ears.hear(sealed(MessageType::frame, payload, crc32_of(geometry)));
  EXPECT_EQ(ears.taken.back(), Taken::frame);
  EXPECT_EQ(ears.reader.taken(Taken::no_geometry), 2u);
}

TEST(StreamFrameReader, AGeometryThatContradictsItselfIsNamedAndHidesTheOneBefore) {
  const Bytes good = scanner_geometry();
  for (const auto& [bytes, reason] : {std::pair(with<std::uint8_t>(good, 0, 4), "projection: expected 0 … 3"),
                                      {with<std::uint8_t>(good, 1, 2), "word_bytes"},
                                      {with<std::uint16_t>(good, 4, 0), "rows, columns"},
                                      {with<std::uint16_t>(good, 8, 4), "trusted_rows"},
                                      {with<double>(good, 48, 0.0), "range_per_count_m"},
                                      {with<double>(good, 104, -1.0), "ambiguity_m"},
                                      {with<double>(good, 136, 9.0), "T_body_sensor"},
                                      {with<double>(good, 120, std::nan("")), "T_body_sensor"},
                                      {with<double>(good, 168, std::nan("")), "noise and range limits"},
                                      {with<std::uint8_t>(good, 216, 7), "device"},
                                      {with<std::int64_t>(good, 16, -1), "row_period_ns"}}) {
    Ears ears;
    ears.hear(sealed(MessageType::geometry, good, crc32_of(good)));
    ears.hear(sealed(MessageType::geometry, bytes, crc32_of(bytes)));
    EXPECT_EQ(ears.taken.back(), Taken::bad_geometry) << reason;
    EXPECT_THAT(ears.reader.reason(), ::testing::HasSubstr(reason));
    ears.hear(sealed(MessageType::frame, frame_payload(test_frame(0)), crc32_of(good)));
    EXPECT_EQ(ears.taken.back(), Taken::no_geometry) << "the device is not what it was";
    EXPECT_THAT(ears.reader.reason(), ::testing::HasSubstr(reason)) << "the frame says why";
  }
}

TEST(StreamFrameReader, WeakReturnsAreNoReturns) {
  Ears ears;
  ears.reader = FrameReader(
      [](SensorConfig told) -> Result<SensorConfig> {
        told.filter.min_reflectance = 4095 - 7 * 5;
        return told;
      },
      true);
  ears.hear(encoded(test_encoder(), test_frame(0)));
  ASSERT_EQ(ears.frames.size(), 1u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(std::isnan(ears.frames[0].range_m[i]), i > 5) << i;
}

TEST(StreamFrameReader, TheCountsArriveAsTheDeviceToldThem) {
  const TestFrame sent = test_frame(0);
  Ears ears;
  ears.hear(encoded(test_encoder(), sent));
  ASSERT_EQ(ears.frames.size(), 1u);
  EXPECT_EQ(ears.frames[0].raw, sent.raw);
  EXPECT_EQ(ears.frames[0].reflectance, sent.reflectance);
}

TEST(StreamFrameReader, TwoByteWordsTellNoReflectanceEvenInAFrameThatHeldSome) {
  Geometry geometry = test_scanner();
  geometry.word_bytes = 2;
  geometry.sensor.projection.reflectance_shift = 0;
  const auto narrow = Encoder::make(geometry, kTestBoot, true);
  ASSERT_TRUE(narrow) << narrow.error().message;
  const TestFrame sent = test_frame(1);
  Bytes bytes = encoded(test_encoder(), test_frame(0));
  const Bytes behind = encoded(*narrow, sent);
  bytes.insert(bytes.end(), behind.begin(), behind.end());
  Decoder decoder;
  FrameReader reader(as_told, true);
  RangeFrame frame;
  std::vector<std::size_t> reflectances;
  std::span<const std::uint8_t> left(bytes);
  while (const auto message = decoder.next(left))
    if (*reader.take(*message, frame) == Taken::frame) reflectances.push_back(frame.reflectance.size());
  EXPECT_EQ(reflectances, (std::vector<std::size_t>{12, 0}));
  EXPECT_EQ(frame.raw, sent.raw);
}

TEST(StreamFrameReader, GapsInTheNumbersOfABootAreCounted) {
  const Encoder encoder = test_encoder();
  const auto other = Encoder::make(test_scanner(), 99, true);
  Ears ears;
  for (const std::uint64_t sequence : {5u, 6u, 9u, 10u}) ears.hear(encoded(encoder, test_frame(sequence)));
  EXPECT_EQ(ears.reader.missing(), 2u);
  ears.hear(encoded(*other, test_frame(50)));
  ears.hear(encoded(*other, test_frame(52)));
  EXPECT_EQ(ears.reader.missing(), 3u) << "another boot counts anew";
}

TEST(StreamFrameReader, ADeviceThatIsNotTheConfiguredOneIsNamedByParameter) {
  const ProjectionConfig expected = test_scanner().sensor.projection;
  EXPECT_TRUE(check_same_projection("stream", expected, expected));
  ProjectionConfig found = expected;
  found.range_per_count_m *= 1.001;
  const auto status = check_same_projection("stream unix:/tmp/a", expected, found);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::bad_config);
  EXPECT_THAT(status.error().message,
              ::testing::StartsWith("stream unix:/tmp/a: sensor.parameters.range_per_count_m: expected 0.009765625, as "
                                    "configured, found a device that says 0.0097"));
  found = expected;
  found.kind = ProjectionKind::perceptron_usf;
  EXPECT_THAT(check_same_projection("s", expected, found).error().message,
              ::testing::HasSubstr("sensor.projection: expected perceptron_cmu"));
}

TEST(StreamFrameReader, EverySimulatedSensorsFrameArrivesToTheLastBit) {
  for (const char* name : {"perceptron-usf", "perceptron-cmu", "lidar64", "depth", "depth-small"}) {
    const Simulator simulator = made(small_drive(name, true));
    SerialExecutor executor;
    const auto rendered = simulator.render(1, executor);
    ASSERT_TRUE(rendered);
    const auto expected = simulator.range_frame(*rendered, std::chrono::hours(1000));
    Geometry geometry{simulator.description().sensor, 2, name};
    const auto encoder = Encoder::make(geometry, 1, true);
    ASSERT_TRUE(encoder) << encoder.error().message;
    std::vector<StampedPose> poses = simulator.odometry().poses();
    for (StampedPose& pose : poses) pose.time += std::chrono::hours(1000);
    Bytes bytes;
    const auto done = encoder->encode({1,
                                       expected->row_time,
                                       std::span(poses).first(std::min<std::size_t>(poses.size(), kMaxPoses)),
                                       {},
                                       rendered->raw,
                                       rendered->reflectance},
                                      bytes);
    ASSERT_TRUE(done) << done.error().message;
    Ears ears;
    ears.hear(bytes);
    ASSERT_EQ(ears.frames.size(), 1u) << name << ": " << ears.reader.reason();
    const RangeFrame& frame = ears.frames[0];
    EXPECT_TRUE(same_bits(frame.range_m, expected->range_m)) << name;
    EXPECT_EQ(frame.raw, rendered->raw) << name;
    EXPECT_TRUE(same_bits(frame.projection->direction_x, expected->projection->direction_x)) << name;
    EXPECT_EQ(frame.row_time, expected->row_time);
    for (std::size_t r = 0; r < frame.T_map_body.size(); ++r) {
      ASSERT_EQ(frame.T_map_body[r].translation_m, expected->T_map_body[r].translation_m) << name << " row " << r;
      ASSERT_EQ(frame.T_map_body[r].rotation.coeffs(), expected->T_map_body[r].rotation.coeffs())
          << name << " row " << r;
    }
    EXPECT_EQ(frame.sensor->T_body_sensor.rotation.coeffs(), expected->sensor->T_body_sensor.rotation.coeffs());
  }
}

}  // namespace
}  // namespace scree::drivers::stream
