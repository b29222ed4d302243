#pragma once
// Which datagrams of one sender were seen: duplicates, reordering and gaps.

#include <algorithm>
#include <bitset>
#include <cstdint>

namespace scree::node::protocol {

/// Sliding window over the seq of one boot_id.
class SequenceWindow {
 public:
  static constexpr std::uint64_t kWindow = 1024;  ///< datagrams; a third of a second at the default pacing

  enum class Verdict : std::uint8_t { fresh, duplicate, too_old };

  Verdict note(std::uint64_t seq) {
    if (received_ == 0) return first(seq);
    if (seq > highest_) {
      const std::uint64_t step = seq - highest_;
      if (step >= kWindow)
        seen_.reset();
      else
        for (std::uint64_t i = 1; i < step; ++i) seen_.reset((highest_ + i) % kWindow);
      highest_ = seq;
    } else {
      if (highest_ - seq >= kWindow) return Verdict::too_old;
      if (seen_.test(seq % kWindow)) return Verdict::duplicate;
      first_ = std::min(first_, seq);
    }
    seen_.set(seq % kWindow);
    ++received_;
    return Verdict::fresh;
  }

  /// Gaps that no late datagram has filled (yet).
  std::uint64_t lost() const { return received_ == 0 ? 0 : highest_ - first_ + 1 - received_; }

 private:
  Verdict first(std::uint64_t seq) {
    first_ = highest_ = seq;
    received_ = 1;
    seen_.reset();
    seen_.set(seq % kWindow);
    return Verdict::fresh;
  }

  std::bitset<kWindow> seen_;
  std::uint64_t first_ = 0;
  std::uint64_t highest_ = 0;
  std::uint64_t received_ = 0;
};

}  // namespace scree::node::protocol
