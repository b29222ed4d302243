#include "node/protocol_header.hpp"

#include <algorithm>
#include <cassert>
#include <sodium.h>
#include <zlib.h>

#include "node/protocol_bytes.hpp"

namespace scree::node::protocol {
namespace {

constexpr std::size_t kCrcOffset = 60;
constexpr std::array<std::uint8_t, 4> kMagic = {'S', 'C', 'R', 'E'};
constexpr int kOriginShift = 4;
constexpr std::uint8_t kOriginMask = 3;
constexpr std::uint8_t kFlagMask = kFlagMac | kFlagRefresh | kFlagRepeat | kFlagClockLocked;

std::uint8_t flags_byte(const Header& header, bool has_mac) {
  const unsigned flags = (header.flags & kFlagMask & ~unsigned{kFlagMac}) | (has_mac ? unsigned{kFlagMac} : 0U);
  return static_cast<std::uint8_t>(flags | (static_cast<unsigned>(header.origin) << kOriginShift));
}

Reject check_mac(std::span<const std::uint8_t> datagram, std::size_t end, std::uint16_t key_id, const KeyRing& keys) {
  const bool has_mac = end != datagram.size();
  if (!has_mac && keys.empty()) return Reject::none;
  const Key* const key = has_mac ? keys.find(key_id) : nullptr;
  if (key == nullptr || !mac_matches(datagram.first(end), *key, datagram.subspan(end))) return Reject::mac;
  return Reject::none;
}

/// The fields after the lengths, in wire order.
void read_fields(ByteReader& reader, Header& header) {
  header.stream_id = reader.get<std::uint32_t>();
  header.boot_id = reader.get<std::uint64_t>();
  header.seq = reader.get<std::uint64_t>();
  header.t_data_ns = reader.get<std::int64_t>();
  header.age_us = reader.get<std::uint32_t>();
  header.map_rev = reader.get<std::uint32_t>();
  header.health = reader.get<std::uint16_t>();
  header.cost_profile = reader.get<std::uint16_t>();
  header.config_hash = reader.get<std::uint32_t>();
  header.key_id = reader.get<std::uint16_t>();
}

}  // namespace

void seal(const Header& header, std::size_t body_bytes, Datagram& datagram, const Key* key) {
  const std::size_t end = kHeaderBytes + body_bytes;
  datagram.size = end + (key != nullptr ? kMacBytes : 0);
  assert(datagram.size <= kMaxDatagramBytes);
  ByteWriter writer{std::span(datagram.bytes).first(kHeaderBytes)};
  for (const std::uint8_t byte : kMagic) writer.put(byte);
  writer.put(kVersionMajor);
  writer.put(header.ver_minor);
  writer.put(static_cast<std::uint8_t>(header.type));
  writer.put(flags_byte(header, key != nullptr));
  writer.put(static_cast<std::uint16_t>(kHeaderBytes));
  writer.put(static_cast<std::uint16_t>(datagram.size));
  writer.put(header.stream_id);
  writer.put(header.boot_id);
  writer.put(header.seq);
  writer.put(header.t_data_ns);
  writer.put(header.age_us);
  writer.put(header.map_rev);
  writer.put(header.health);
  writer.put(header.cost_profile);
  writer.put(header.config_hash);
  writer.put(key != nullptr ? key->id : std::uint16_t{0});
  writer.put(std::uint16_t{0});
  const auto before_mac = std::span(datagram.bytes).first(end);
  writer.put(datagram_crc(before_mac));
  if (key == nullptr) return;
  const Mac mac = compute_mac(before_mac, key->bytes);
  std::copy(mac.begin(), mac.end(), datagram.bytes.begin() + static_cast<std::ptrdiff_t>(end));
}

Reject open_datagram(std::span<const std::uint8_t> datagram, Opened& out, const KeyRing& keys) {
  if (datagram.size() < kHeaderBytes) return Reject::too_short;
  if (datagram.size() > kMaxDatagramBytes) return Reject::too_long;
  ByteReader reader(datagram);
  for (const std::uint8_t byte : kMagic)
    if (reader.get<std::uint8_t>() != byte) return Reject::magic;
  if (reader.get<std::uint8_t>() != kVersionMajor) return Reject::version;

  Header& header = out.header;
  header.ver_minor = reader.get<std::uint8_t>();
  header.type = static_cast<MessageType>(reader.get<std::uint8_t>());
  const auto flags = reader.get<std::uint8_t>();
  header.flags = flags & kFlagMask;
  header.origin = static_cast<drivers::Origin>((flags >> kOriginShift) & kOriginMask);
  const std::size_t header_length = reader.get<std::uint16_t>();
  const std::size_t total_length = reader.get<std::uint16_t>();
  if (total_length != datagram.size()) return Reject::total_length;

  const bool has_mac = (flags & kFlagMac) != 0;
  if (has_mac && total_length < kHeaderBytes + kMacBytes) return Reject::too_short;
  const std::size_t end = total_length - (has_mac ? kMacBytes : 0);
  if (header_length < kHeaderBytes || header_length > end) return Reject::header_length;

  read_fields(reader, header);
  ByteReader crc(datagram.subspan(kCrcOffset, 4));
  if (crc.get<std::uint32_t>() != datagram_crc(datagram.first(end))) return Reject::crc;
  if (const Reject reason = check_mac(datagram, end, header.key_id, keys); reason != Reject::none) return reason;
  out.body = datagram.subspan(header_length, end - header_length);
  return Reject::none;
}

std::uint32_t datagram_crc(std::span<const std::uint8_t> before_mac) {
  constexpr std::array<std::uint8_t, 4> kZero{};
  const auto rest = before_mac.subspan(kHeaderBytes);
  uLong crc = crc32(0L, before_mac.data(), kCrcOffset);
  crc = crc32(crc, kZero.data(), kZero.size());
  if (!rest.empty()) crc = crc32(crc, rest.data(), static_cast<uInt>(rest.size()));
  return static_cast<std::uint32_t>(crc);
}

std::uint32_t config_hash(std::string_view canonical_configuration) {
  std::array<std::uint8_t, crypto_generichash_BYTES_MAX> digest{};  // 64 bytes: plain BLAKE2b
  crypto_generichash(digest.data(), digest.size(),
                     reinterpret_cast<const unsigned char*>(canonical_configuration.data()),
                     canonical_configuration.size(), nullptr, 0);
  return ByteReader(digest).get<std::uint32_t>();
}

}  // namespace scree::node::protocol
