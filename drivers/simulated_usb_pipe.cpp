#include "drivers/simulated_usb_pipe.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "drivers/simulated_usb_descriptors.hpp"

namespace scree::drivers::usb {

void BulkPipe::cancel(std::uint64_t id, const AnswerSink& sink) {
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [id](const Asked& a) { return a.id == id; });
  if (found == waiting_.end()) return;
  waiting_.erase(found);
  sink({endpoint_, id, TransferStatus::cancelled, {}});
}

bool BulkPipe::offer(SharedBytes message) {
  const bool idle = message_ == nullptr;
  if (!idle && begun_) return false;
  message_ = std::move(message);
  sent_ = 0;
  begun_ = false;
  return idle;
}

int BulkPipe::pump(const LinkState& link, MonotonicTime now, const AnswerSink& sink) {
  int ended = 0;
  if (link.unplugged || link.frozen) return ended;
  while (!waiting_.empty()) {
    const Asked asked = waiting_.front();
    if (!answer_fault(asked, sink)) {
      if (message_ == nullptr) break;
      if (!std::exchange(begun_, true)) began_ = now;
      const auto elapsed = std::chrono::duration_cast<Duration>(now - began_);
      if (!answer_data(asked, link.allowed(message_->size(), elapsed), sink)) break;
      if (sent_ == message_->size() && !owes_zlp_) {
        message_ = nullptr;
        ++ended;
      }
    }
    waiting_.pop_front();
  }
  return ended;
}

bool BulkPipe::answer_fault(const Asked& asked, const AnswerSink& sink) {
  if (halted_) {
    sink({endpoint_, asked.id, TransferStatus::stall, {}});
    return true;
  }
  if (!std::exchange(babbles_, false)) return false;
  const std::vector<std::uint8_t> noise(asked.bytes, 0xBB);
  sink({endpoint_, asked.id, TransferStatus::babble, noise});
  return true;
}

/// False: not enough may have left yet.
bool BulkPipe::answer_data(const Asked& asked, std::size_t allowed, const AnswerSink& sink) {
  const std::size_t rest = message_->size() - sent_, count = std::min(rest, asked.bytes);
  if (sent_ + count > allowed) return false;
  const bool overflows = rest > asked.bytes && asked.bytes % kBulkPacketBytes != 0;
  sink({endpoint_, asked.id, overflows ? TransferStatus::babble : TransferStatus::success,
        std::span(*message_).subspan(sent_, count)});
  sent_ += count;
  owes_zlp_ = count > 0 && sent_ == message_->size() && count == asked.bytes && count % kBulkPacketBytes == 0;
  return true;
}

bool BulkPipe::drop_message() {
  const bool begun = message_ != nullptr && (sent_ > 0 || owes_zlp_);
  message_ = nullptr;
  sent_ = 0;
  owes_zlp_ = false;
  return begun;
}

bool BulkPipe::reset(const AnswerSink& sink) {
  while (!waiting_.empty()) cancel(waiting_.front().id, sink);
  halted_ = babbles_ = false;
  return drop_message();
}

}  // namespace scree::drivers::usb
