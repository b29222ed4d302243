#include "drivers/frame_stream_decoder.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers::stream {
namespace {

constexpr std::size_t kCrcAt = kHeaderBytes - 4;

Header parse_header(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes.subspan(5));
  Header header;
  header.version_minor = in.take<std::uint8_t>();
  header.type = static_cast<MessageType>(in.take<std::uint8_t>());
  header.simulated = (in.take<std::uint8_t>() & kFlagSimulated) != 0;
  header.payload_bytes = in.take<std::uint32_t>();
  header.payload_crc = in.take<std::uint32_t>();
  header.boot_id = in.take<std::uint64_t>();
  header.sequence = in.take<std::uint64_t>();
  header.geometry_id = in.take<std::uint32_t>();
  return header;
}

}  // namespace

std::optional<Message> Decoder::next(std::span<const std::uint8_t>& bytes) {
  begin_ += std::exchange(returned_, 0);
  for (;;) {
    if (!header_) {
      skip_to_magic();
      if (!fill(kHeaderBytes, bytes)) {
        skip_to_magic();  // garbage is not held until 48 bytes of it are there
        return std::nullopt;
      }
      if (!std::equal(kMagic.begin(), kMagic.end(), held_bytes().begin())) continue;
      header_ = judge_header();
      if (!header_) {
        skip(1);
        continue;
      }
    }
    if (!fill(kHeaderBytes + header_->payload_bytes, bytes)) return std::nullopt;
    const Header header = *header_;
    header_.reset();
    const auto payload = held_bytes().subspan(kHeaderBytes, header.payload_bytes);
    if (payload_crc(payload) != header.payload_crc) {
      searched_to_ = std::max(searched_to_, position() + kHeaderBytes + header.payload_bytes);
      ++counters_.payload_crc;
      if (header.type == MessageType::frame) ++counters_.frame_payload_crc;
      skip(kHeaderBytes);  // a header that is whole holds no other; its payload may
      continue;
    }
    ++counters_.messages;
    returned_ = kHeaderBytes + header.payload_bytes;
    return Message{header, payload};
  }
}

void Decoder::reset() {
  begin_ += std::exchange(returned_, 0);
  skip(held());
  header_.reset();
}

/// Headers found inside a damaged message may announce overlapping payloads, each of them damaged too.
std::uint32_t Decoder::payload_crc(std::span<const std::uint8_t> payload) {
  if (position() >= searched_to_) {
    counters_.work += payload.size();
    return crc32_of(payload);
  }
  const std::uint64_t before = parts_.bytes_read();
  const std::uint32_t crc = parts_.crc(payload, position() + kHeaderBytes);
  counters_.work += parts_.bytes_read() - before;
  return crc;
}

/// Copies what is missing of `need`; false when `bytes` did not hold that much.
bool Decoder::fill(std::size_t need, std::span<const std::uint8_t>& bytes) {
  if (held() >= need) return true;
  if (begin_ == end_) begin_ = end_ = 0;
  if (begin_ + need > buffer_.size()) make_room(need);
  const std::size_t taken = std::min(need - held(), bytes.size());
  if (taken > 0) std::memcpy(buffer_.data() + end_, bytes.data(), taken);
  end_ += taken;
  counters_.bytes += taken;
  bytes = bytes.subspan(taken);
  return held() >= need;
}

/// Moves what is held only if as much has gone before it: so each byte pays for at most one move of another.
void Decoder::make_room(std::size_t need) {
  if (held() <= begin_) {
    if (held() > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, held());
    counters_.work += held();
    end_ -= std::exchange(begin_, 0);
  }
  if (begin_ + need <= buffer_.size()) return;
  counters_.work += end_;
  buffer_.resize(begin_ == 0 ? need : 2 * need);  // begin_ < held() < need
}

void Decoder::skip(std::size_t bytes) {
  begin_ += bytes;
  counters_.bytes_skipped += bytes;
}

/// To the first place from which on everything held could be the beginning of a magic.
void Decoder::skip_to_magic() {
  const auto bytes = held_bytes();
  std::size_t at = 0;
  while (at < bytes.size()) {
    const void* found = std::memchr(bytes.data() + at, kMagic[0], bytes.size() - at);
    if (found == nullptr) {
      at = bytes.size();
      break;
    }
    at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data());
    const std::size_t seen = std::min(kMagic.size(), bytes.size() - at);
    if (std::equal(kMagic.begin(), kMagic.begin() + static_cast<std::ptrdiff_t>(seen), bytes.begin() + at)) break;
    ++at;
  }
  skip(at);
}

std::optional<Header> Decoder::judge_header() {
  const auto bytes = held_bytes().first(kHeaderBytes);
  counters_.work += kCrcAt;
  if (crc32_of(bytes.first(kCrcAt)) != read_number<std::uint32_t>(bytes.data() + kCrcAt)) {
    ++counters_.header_crc;
    return std::nullopt;
  }
  if (bytes[4] != kVersionMajor) {
    ++counters_.version;
    return std::nullopt;
  }
  const Header header = parse_header(bytes);
  if (header.payload_bytes > kMaxPayloadBytes) {
    ++counters_.oversize;
    return std::nullopt;
  }
  return header;
}

}  // namespace scree::drivers::stream
