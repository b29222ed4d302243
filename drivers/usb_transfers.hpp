#pragma once
// Bulk IN transfers in flight, taken in the order in which they were submitted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "drivers/usb_interface.hpp"

struct libusb_device_handle;

namespace scree::drivers::usb {

/// 512 KiB in flight are 13 ms at the 40 MB/s of high speed and 1.3 ms at the 400 MB/s of SuperSpeed, while a frame is
/// decoded or the thread is not scheduled; of the 16 MB that Linux grants all USB programs together they are 3 %.
/// 64 KiB are whole packets at every speed (64, 512, 1024 bytes), so that a packet never overflows the end of a buffer,
/// and short enough that a frame is not held up while a large buffer fills.
inline constexpr std::size_t kTransfers = 8;
inline constexpr std::size_t kTransferBytes = std::size_t{64} << 10;

enum class TransferEnd : std::uint8_t { completed, timed_out, stalled, overflow, error, no_device, cancelled };
const char* to_string(TransferEnd status);

/// A transfer that has come back. `bytes` hold until Transfers::release().
struct Completion {
  TransferEnd status = TransferEnd::completed;
  std::span<const std::uint8_t> bytes;  ///< what arrived, also if the status is another; may be none
};

/// One thread, that of Context::handle_events(). No allocation of ours after make().
class Transfers {
 public:
  /// Buffers are the whole packets in kTransferBytes. Errors: unavailable (no memory).
  static Result<std::unique_ptr<Transfers>> make(libusb_device_handle* handle, const Interface& interface);
  /// Frees what is not in flight. What still is stays allocated for good, because libusb may touch it: cancel and drain
  /// before.
  ~Transfers();
  Transfers(const Transfers&) = delete;
  Transfers& operator=(const Transfers&) = delete;

  /// Submits all that are idle. The code of libusb: 0 or that of the first that failed; those before it are in flight.
  int submit();
  /// The oldest one, if it has come back.
  std::optional<Completion> front() const;
  /// The oldest one's bytes were used: it is submitted behind the others. The code of libusb; if not 0 it is idle.
  int release();
  /// The oldest one's bytes were used: it is idle.
  void retire();
  /// Asks for all back. They come as events are handled, each with what had arrived.
  void cancel();
  /// What came back is idle, its bytes forgotten. Only with none in flight.
  void discard();

  std::size_t in_flight() const { return in_flight_; }

  /// Transfers allocated and not freed, in the whole process; abandoned: those that never came back.
  static std::size_t live();
  static std::size_t abandoned();

 private:
  struct Slot;
  struct Callbacks;
  Transfers() = default;
  int submit(Slot& slot);

  std::array<std::unique_ptr<Slot>, kTransfers> slots_;
  std::size_t head_ = 0;  ///< oldest
  std::size_t in_flight_ = 0;
};

}  // namespace scree::drivers::usb
