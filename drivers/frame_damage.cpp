#include "drivers/frame_damage.hpp"

#include <algorithm>

#include "core/random.hpp"
#include "drivers/checksum.hpp"
#include "drivers/frame_stream.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers {
namespace {

// docs/frame-stream.md, "Messages"
constexpr std::size_t kPayloadLengthAt = 8, kPayloadCrcAt = 12, kGeometryIdAt = 32, kHeaderCrcAt = 44;

void put_u32(std::span<std::uint8_t> header, std::size_t at, std::uint32_t value) {
  ByteWriter(header.subspan(at, 4)).put(value);
}

}  // namespace

void flip_bytes(std::span<std::uint8_t> bytes, std::uint64_t seed) {
  for (int i = 0; i < kFlippedBytes; ++i) {
    const std::size_t begin = bytes.size() * static_cast<std::size_t>(i) / kFlippedBytes;
    const std::size_t end = bytes.size() * static_cast<std::size_t>(i + 1) / kFlippedBytes;
    if (begin == end) continue;
    std::uint8_t& byte = bytes[begin + random_words(seed, 0, i, 0)[0] % (end - begin)];
    byte = static_cast<std::uint8_t>(~byte);
  }
}

std::vector<std::uint8_t> with_other_geometry(std::span<const std::uint8_t> message,
                                              std::span<const std::uint8_t> geometry_payload) {
  const auto old_payload = read_number<std::uint32_t>(message.data() + kPayloadLengthAt);
  const auto frame = message.subspan(stream::kHeaderBytes + old_payload);
  const std::uint32_t id = crc32_of(geometry_payload);
  const std::size_t frame_at = stream::kHeaderBytes + geometry_payload.size();
  std::vector<std::uint8_t> out(frame_at + frame.size());
  std::copy_n(message.begin(), stream::kHeaderBytes, out.begin());
  std::copy(geometry_payload.begin(), geometry_payload.end(), out.begin() + stream::kHeaderBytes);
  std::copy(frame.begin(), frame.end(), out.begin() + static_cast<std::ptrdiff_t>(frame_at));
  const auto geometry_header = std::span(out).first(stream::kHeaderBytes);
  put_u32(geometry_header, kPayloadLengthAt, static_cast<std::uint32_t>(geometry_payload.size()));
  put_u32(geometry_header, kPayloadCrcAt, id);
  const auto frame_header = std::span(out).subspan(frame_at, stream::kHeaderBytes);
  for (const auto header : {geometry_header, frame_header}) {
    put_u32(header, kGeometryIdAt, id);
    put_u32(header, kHeaderCrcAt, crc32_of(header.first(kHeaderCrcAt)));
  }
  return out;
}

}  // namespace scree::drivers
