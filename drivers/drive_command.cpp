#include "drivers/drive_command.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers {
namespace {

constexpr std::size_t kCrcAt = kDriveBytes - 4;

}  // namespace

void encode_drive(const DriveCommand& command, std::span<std::uint8_t, kDriveBytes> out) {
  ByteWriter writer(out);
  for (const std::uint8_t byte : kDriveMagic) writer.put(byte);
  writer.put(kDriveVersion);
  writer.fill(3);
  writer.put(command.boot_id);
  writer.put(command.sequence);
  writer.put(command.speed_mps);
  writer.put(command.curvature_per_m);
  writer.put(crc32_of(out.first(kCrcAt)));
}

std::optional<DriveCommand> decode_drive(std::span<const std::uint8_t> datagram) {
  if (datagram.size() != kDriveBytes) return std::nullopt;
  if (!std::equal(kDriveMagic.begin(), kDriveMagic.end(), datagram.begin()) || datagram[4] != kDriveVersion)
    return std::nullopt;
  if (crc32_of(datagram.first(kCrcAt)) != read_number<std::uint32_t>(datagram.data() + kCrcAt)) return std::nullopt;
  ByteReader in(datagram.subspan(8));
  DriveCommand command;
  command.boot_id = in.take<std::uint64_t>();
  command.sequence = in.take<std::uint64_t>();
  command.speed_mps = in.take<float>();
  command.curvature_per_m = in.take<float>();
  const bool possible = std::abs(command.speed_mps) <= kMaxDriveSpeed_mps &&
                        std::abs(command.curvature_per_m) <= kMaxDriveCurvature_per_m;  // false for NaN
  return possible ? std::optional(command) : std::nullopt;
}

std::optional<DriveCommand> DriveReceiver::accept(std::span<const std::uint8_t> datagram) {
  const auto command = decode_drive(datagram);
  if (!command || (boot_id_ == command->boot_id && command->sequence <= sequence_)) {
    ++rejected_;
    return std::nullopt;
  }
  boot_id_ = command->boot_id;
  sequence_ = command->sequence;
  ++accepted_;
  return command;
}

}  // namespace scree::drivers
