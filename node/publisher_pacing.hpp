#pragma once
// How fast datagrams may leave.

#include <algorithm>

#include "core/time.hpp"

namespace scree::node {

/// Tokens arrive at `per_second` up to `capacity`, 20 ms worth. A message in progress may overdraw; the debt is paid
/// first.
class TokenBucket {
 public:
  explicit TokenBucket(double per_second) : TokenBucket(per_second, std::max(per_second * 0.02, 4.0)) {}
  TokenBucket(double per_second, double capacity)
      : per_second_(std::max(per_second, 1.0)), capacity_(capacity), tokens_(capacity) {}

  void refill(MonotonicTime now) {
    if (filled_ != MonotonicTime{} && now > filled_)
      tokens_ = std::min(capacity_, tokens_ + per_second_ * to_seconds(now - filled_));
    filled_ = std::max(filled_, now);
  }
  void take(double tokens) { tokens_ -= tokens; }
  bool has_token() const { return tokens_ >= 1.0; }
  /// Until a quarter of the bucket is there, so that the sender does not wake for every single datagram.
  Duration until_worthwhile() const {
    const double missing = std::max(capacity_ * 0.25, 1.0) - tokens_;
    return missing > 0.0 ? from_seconds(missing / per_second_) : Duration{0};
  }
  double per_second() const { return per_second_; }

 private:
  double per_second_;
  double capacity_;
  double tokens_;
  MonotonicTime filled_{};
};

}  // namespace scree::node
