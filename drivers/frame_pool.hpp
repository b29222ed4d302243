#pragma once
// Range frames that come back when their last reader lets go: no allocation of pixels after warm-up.

#include <memory>
#include <mutex>
#include <vector>

#include "drivers/frame/range_frame.hpp"

namespace scree::drivers {

/// take() may be called by one thread; frames may be released by any, also after the pool is gone.
class FramePool {
 public:
  /// A frame with the buffers, and the stale contents, of an earlier one.
  std::shared_ptr<RangeFrame> take() {
    std::unique_ptr<RangeFrame> frame;
    {
      const std::lock_guard lock(shelf_->mutex);
      if (!shelf_->free.empty()) {
        frame = std::move(shelf_->free.back());
        shelf_->free.pop_back();
      }
    }
    if (!frame) frame = std::make_unique<RangeFrame>();
    return {frame.release(), [shelf = shelf_](RangeFrame* released) {
              std::unique_ptr<RangeFrame> owned(released);
              const std::lock_guard lock(shelf->mutex);
              if (shelf->free.size() < shelf->free.capacity()) shelf->free.push_back(std::move(owned));
            }};
  }

 private:
  static constexpr std::size_t kCapacity = 16;
  struct Shelf {
    Shelf() { free.reserve(kCapacity); }
    std::mutex mutex;
    std::vector<std::unique_ptr<RangeFrame>> free;
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace scree::drivers
