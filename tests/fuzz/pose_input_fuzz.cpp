// The node's receiver of poses: history, clock, boots. An input is a session: for each datagram a command byte and
// 40 bytes: boot_id (one of a few), seq, time, position and rotation, coarse enough that they repeat, order and
// contradict each other. total_len and CRC always fit; bit 7 of the command spoils one byte behind the CRC instead.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "node/pose_input.hpp"

namespace {

using namespace scree;
using namespace scree::node;

constexpr std::size_t kRecordBytes = 41;
constexpr std::uint32_t kStream = 7;

void expect(bool condition) {
  if (!condition) std::abort();
}

/// The codec's own datagram, then fields as they come: also NaN, infinite and far from a rotation.
protocol::Datagram make_datagram(std::span<const std::uint8_t> record) {
  protocol::Header header;
  header.stream_id = kStream;
  header.boot_id = record[1] % 12u;
  header.seq = record[2];
  protocol::PoseInputMessage message;
  // from just before what is too old, at 20 s, to just after what is too far ahead, at 31 s
  message.time = Time(std::chrono::milliseconds(19'500 + (record[3] | record[4] << 8) % 12'000));
  protocol::Datagram datagram;
  protocol::encode(header, message, datagram);
  const std::size_t body = protocol::kHeaderBytes;
  if (record[0] & 1) std::memcpy(&datagram.bytes[body + 8], &record[5], 24);    // position
  if (record[0] & 2) std::memcpy(&datagram.bytes[body + 32], &record[5], 32);   // rotation
  if (record[0] & 4) std::memcpy(&datagram.bytes[body], &record[29], 8);        // time
  if (record[0] & 8) std::memcpy(&datagram.bytes[24], &record[37], 4);          // seq
  if (record[0] & 16) std::memcpy(&datagram.bytes[body + 64], &record[5], 24);  // variances
  const std::uint32_t crc = protocol::datagram_crc(datagram.view());
  for (std::size_t i = 0; i < 4; ++i) datagram.bytes[60 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  if (record[0] & 128) datagram.bytes[record[40] % datagram.size] ^= static_cast<std::uint8_t>(record[39] | 1);
  return datagram;
}

/// What is kept is in order, finite and answers only for its own time.
void check_history(const PoseHistory& history) {
  const auto newest = history.newest();
  expect(newest.has_value() == (history.size() > 0));
  if (!newest) return;
  expect(history.at(newest->time).has_value());
  expect(newest->time == Time::max() || !history.at(newest->time + Duration(1)));
  expect(std::abs(newest->T_map_body.rotation.norm() - 1.0) < 1e-2);
  expect(newest->T_map_body.translation_m.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Endpoint from = *parse_endpoint("127.0.0.1:1", "fuzz");
  const Endpoint foreign = *parse_endpoint("127.0.0.2:1", "fuzz");
  PoseReceiver receiver(from, kStream);
  const Time now(std::chrono::seconds(30));
  for (std::span<const std::uint8_t> input(data, size); input.size() >= kRecordBytes;
       input = input.subspan(kRecordBytes)) {
    const auto record = input.first(kRecordBytes);
    const protocol::Datagram datagram = make_datagram(record);
    const auto before = receiver.history().newest();
    const std::size_t kept = receiver.history().size();
    const bool taken = receiver.accept(datagram.view(), record[0] & 64 ? foreign : from, now);
    const auto after = receiver.history().newest();
    if (taken)
      expect(after && after->time <= now + std::chrono::seconds(1));
    else  // a refused datagram changes nothing that is kept
      expect(receiver.history().size() == kept && (!before || before->time == after->time));
    check_history(receiver.history());
  }
  const PoseInputCounters& counters = receiver.counters();
  std::uint64_t reasons = counters.foreign_address + counters.not_later + counters.in_future + counters.in_past;
  for (const std::uint64_t count : counters.rejected_by) reasons += count;
  expect(counters.datagrams == counters.accepted + counters.rejected && counters.rejected == reasons);
  return 0;
}
