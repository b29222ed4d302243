#pragma once
// The datagram that drives a simulated robot (docs/simulator.md has the offset table).

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace scree::drivers {

inline constexpr std::array<std::uint8_t, 4> kDriveMagic{'S', 'C', 'D', 'R'};
inline constexpr std::uint8_t kDriveVersion = 1;
inline constexpr std::size_t kDriveBytes = 36;
inline constexpr float kMaxDriveSpeed_mps = 10.0F;
inline constexpr float kMaxDriveCurvature_per_m = 10.0F;

struct DriveCommand {
  std::uint64_t boot_id = 0;     ///< of who sends it
  std::uint64_t sequence = 0;    ///< grows
  float speed_mps = 0.0F;        ///< negative = backwards
  float curvature_per_m = 0.0F;  ///< 1 / radius, positive turns left
};

void encode_drive(const DriveCommand& command, std::span<std::uint8_t, kDriveBytes> out);

/// Nothing unless length, magic, version, CRC and limits are right.
std::optional<DriveCommand> decode_drive(std::span<const std::uint8_t> datagram);

/// Takes commands in their order. datagrams == accepted + rejected.
class DriveReceiver {
 public:
  /// The command, if it is good and later than the last one of its sender. Another boot_id is another sender, or the
  /// same one restarted: it takes over.
  std::optional<DriveCommand> accept(std::span<const std::uint8_t> datagram);

  std::uint64_t accepted() const { return accepted_; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  std::optional<std::uint64_t> boot_id_;
  std::uint64_t sequence_ = 0;
  std::uint64_t accepted_ = 0, rejected_ = 0;
};

}  // namespace scree::drivers
