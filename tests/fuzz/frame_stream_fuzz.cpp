// A frame stream from bytes to range frames. An input is a session: for each record a u16 length, a u8 command and the
// bytes. So that the fuzzer gets past them, magic, version, payload_len and both CRCs are repaired unless the command
// is odd, and a FRAME refers to the last GEOMETRY unless its next bit is set. The other six bits are the size of the
// pieces in which the bytes are heard.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"
#include "drivers/stream_frame_reader.hpp"

namespace {

using namespace scree;
using namespace scree::drivers;
using namespace scree::drivers::stream;

void expect(bool condition) {
  if (!condition) std::abort();
}

/// Small images only: tables of rays take a second for the largest.
Result<SensorConfig> small_sensor(const SensorConfig& told) {
  if (std::int64_t{told.projection.rows} * told.projection.columns > 4096)
    return Error{ErrorKind::bad_config, "expected a small image"};
  return told;
}

class Repairer {
 public:
  void repair(std::vector<std::uint8_t>& bytes, bool refers) {
    if (bytes.size() < kHeaderBytes) return;
    const std::span<std::uint8_t> all(bytes);
    const std::uint32_t crc = crc32_of(all.subspan(kHeaderBytes));
    std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
    bytes[4] = kVersionMajor;
    ByteWriter(all.subspan(8)).put(static_cast<std::uint32_t>(bytes.size() - kHeaderBytes));
    ByteWriter(all.subspan(12)).put(crc);
    if (bytes[6] == 1) geometry_id_ = crc;
    if (refers) ByteWriter(all.subspan(32)).put(geometry_id_);
    ByteWriter(all.subspan(44)).put(crc32_of(all.first(44)));
  }

 private:
  std::uint32_t geometry_id_ = 0;
};

void check_frame(const RangeFrame& frame) {
  expect(frame.projection != nullptr && frame.sensor != nullptr);
  const auto rows = static_cast<std::size_t>(frame.projection->rows);
  expect(frame.range_m.size() == rows * static_cast<std::size_t>(frame.projection->columns));
  expect(frame.row_time.size() == rows && frame.T_map_body.size() == rows && frame.time == frame.row_time.front());
  expect(std::is_sorted(frame.row_time.begin(), frame.row_time.end()));
  for (const Pose& pose : frame.T_map_body)
    expect(pose.translation_m.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-6);
  expect(frame.pose_variance.position_m2.minCoeff() >= 0.0);
}

struct Ears {
  Decoder decoder;
  FrameReader reader{small_sensor, true};
  std::uint64_t message_bytes = 0, messages = 0;

  void hear(std::span<const std::uint8_t> bytes) {
    while (const auto message = decoder.next(bytes)) {
      ++messages;
      message_bytes += kHeaderBytes + message->payload.size();
      RangeFrame frame;
      const auto taken = reader.take(*message, frame);
      if (taken && *taken == Taken::frame) check_frame(frame);
    }
    expect(bytes.empty());
    const DecoderCounters& c = decoder.counters();
    expect(c.bytes == message_bytes + c.bytes_skipped + decoder.held() && c.messages == messages);
    // 6 of each byte's own, 44 for each magic of 4, 44 + 512 for each header of 48 (tests/drivers/stream_work_test.cpp)
    expect(c.work <= (6 + 11 + 12) * c.bytes);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Ears pieces, whole;
  Repairer repairer;
  std::vector<std::uint8_t> all;
  std::span<const std::uint8_t> input(data, size);
  while (input.size() >= 3) {
    const std::size_t length = std::min<std::size_t>(input[0] | input[1] << 8, input.size() - 3);
    const unsigned command = input[2];
    std::vector<std::uint8_t> bytes(input.begin() + 3, input.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    input = input.subspan(3 + length);
    if (command % 2 == 0) repairer.repair(bytes, (command & 2) == 0);
    all.insert(all.end(), bytes.begin(), bytes.end());
    const std::size_t piece = command >= 4 ? command / 4 : bytes.size();
    for (std::span<const std::uint8_t> left(bytes); !left.empty();) {
      const auto now = left.first(std::min(piece, left.size()));
      left = left.subspan(now.size());
      pieces.hear(now);
    }
  }
  whole.hear(all);
  for (std::size_t i = 0; i < kTakenKinds; ++i)
    expect(pieces.reader.taken(static_cast<Taken>(i)) == whole.reader.taken(static_cast<Taken>(i)));
  expect(pieces.decoder.counters().bytes_skipped == whole.decoder.counters().bytes_skipped);
  expect(pieces.decoder.counters().payload_crc == whole.decoder.counters().payload_crc);
  pieces.decoder.reset();
  expect(pieces.decoder.counters().bytes == pieces.message_bytes + pieces.decoder.counters().bytes_skipped);
  return 0;
}
