#pragma once
// One bulk IN endpoint of the simulated device: transfers that the host asked for on one side, messages on the other.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>

#include "drivers/frame_server.hpp"

namespace scree::drivers::usb {

enum class TransferStatus : std::uint8_t { success, cancelled, invalid, stall, babble };

/// A transfer that is over. `bytes` hold during the call.
struct TransferAnswer {
  std::uint8_t endpoint = 0;
  std::uint64_t id = 0;
  TransferStatus status = TransferStatus::success;
  std::span<const std::uint8_t> bytes;
};
using AnswerSink = std::function<void(const TransferAnswer&)>;

/// A message ends with a transfer shorter than asked: with a ZLP of its own where its last transfer was filled exactly
/// and consists of full packets. A transfer of no whole number of packets that ends inside a message overflows, as it
/// does on a bus. Pure: no clock, no socket.
class BulkPipe {
 public:
  explicit BulkPipe(std::uint8_t endpoint) : endpoint_(endpoint) {}

  /// The host waits for up to `bytes`.
  void ask(std::uint64_t id, std::size_t bytes) { waiting_.push_back({id, bytes}); }
  /// Gives up a transfer, answered as cancelled; an unknown one was answered already.
  void cancel(std::uint64_t id, const AnswerSink& sink);
  /// In place of a message that no transfer has waited for yet, not of one under way. False: superseded, this one or
  /// that one.
  bool offer(SharedBytes message);
  /// Answers what can be answered. Returns how many messages ended whole.
  int pump(const LinkState& link, MonotonicTime now, const AnswerSink& sink);

  /// Lets go of the message. True if some of it had left.
  bool drop_message();
  /// Answers every transfer as cancelled; nothing is left. True as of drop_message().
  bool reset(const AnswerSink& sink);
  void halt() { halted_ = true; }
  void clear_halt() { halted_ = false; }
  void babble_next() { babbles_ = true; }
  bool halted() const { return halted_; }
  bool has_message() const { return message_ != nullptr; }

 private:
  struct Asked {
    std::uint64_t id;
    std::size_t bytes;
  };
  bool answer_fault(const Asked& asked, const AnswerSink& sink);
  bool answer_data(const Asked& asked, std::size_t allowed, const AnswerSink& sink);

  std::uint8_t endpoint_;
  std::deque<Asked> waiting_;
  SharedBytes message_;  ///< null = none
  std::size_t sent_ = 0;
  bool owes_zlp_ = false;
  bool begun_ = false;     ///< a transfer has found it: it is on its way
  MonotonicTime began_{};  ///< since then
  bool halted_ = false, babbles_ = false;
};

}  // namespace scree::drivers::usb
