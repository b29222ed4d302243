#pragma once
// Range frames that come back when their last reader lets go: no allocation after warm-up.

#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
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
    const auto put_back = [shelf = shelf_](RangeFrame* released) {
      std::unique_ptr<RangeFrame> owned(released);
      const std::lock_guard lock(shelf->mutex);
      if (shelf->free.size() < shelf->free.capacity()) shelf->free.push_back(std::move(owned));
    };
    return {frame.release(), put_back, CountAllocator<RangeFrame>(shelf_)};
  }

 private:
  static constexpr std::size_t kCapacity = 16;
  struct Shelf {
    Shelf() {
      free.reserve(kCapacity);
      counts.reserve(kCapacity);
    }
    ~Shelf() {
      for (void* count : counts) ::operator delete(count);
    }
    Shelf(const Shelf&) = delete;
    Shelf& operator=(const Shelf&) = delete;
    std::mutex mutex;
    std::vector<std::unique_ptr<RangeFrame>> free;
    std::vector<void*> counts;  ///< where a shared_ptr counts its owners: one type, hence one size
  };

  /// Memory for the one object that a shared_ptr allocates.
  template <class T>
  struct CountAllocator {
    using value_type = T;
    explicit CountAllocator(std::shared_ptr<Shelf> its_shelf) : shelf(std::move(its_shelf)) {}
    template <class U>
    CountAllocator(const CountAllocator<U>& other) : shelf(other.shelf) {}  // NOLINT(google-explicit-constructor)

    T* allocate(std::size_t count) {
      const std::lock_guard lock(shelf->mutex);
      if (shelf->counts.empty()) return static_cast<T*>(::operator new(count * sizeof(T)));
      void* const out = shelf->counts.back();
      shelf->counts.pop_back();
      return static_cast<T*>(out);
    }
    void deallocate(T* memory, std::size_t) {
      const std::lock_guard lock(shelf->mutex);
      if (shelf->counts.size() < shelf->counts.capacity())
        shelf->counts.push_back(memory);
      else
        ::operator delete(memory);
    }
    template <class U>
    bool operator==(const CountAllocator<U>& other) const {
      return shelf == other.shelf;
    }
    std::shared_ptr<Shelf> shelf;
  };

  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace scree::drivers
