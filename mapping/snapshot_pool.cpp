#include "mapping/snapshot_pool.hpp"

#include <array>
#include <cstddef>
#include <mutex>
#include <new>
#include <vector>

namespace scree::mapping {

struct SnapshotPool::Slot {
  MapSnapshot snapshot;
  alignas(std::max_align_t) std::array<std::byte, 128> control_block;
};

struct SnapshotPool::Core {
  std::mutex mutex;
  std::vector<std::unique_ptr<Slot>> slots;
  std::vector<Slot*> free;
};

// The allocator of the control blocks. A slot is free again when its control block is given back, which is after the
// last strong and weak reference has gone.
template <class T>
struct SnapshotPool::InPlace {
  using value_type = T;

  InPlace(std::shared_ptr<Core> pool, Slot* place) : core(std::move(pool)), slot(place) {}
  template <class U>
  InPlace(const InPlace<U>& other) : core(other.core), slot(other.slot) {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) {
    static_assert(sizeof(T) <= sizeof(Slot::control_block) && alignof(T) <= alignof(std::max_align_t));
    static_cast<void>(count);  // one control block
    return reinterpret_cast<T*>(slot->control_block.data());
  }
  void deallocate(T*, std::size_t) {
    const std::lock_guard lock(core->mutex);
    core->free.push_back(slot);
  }
  template <class U>
  bool operator==(const InPlace<U>& other) const {
    return slot == other.slot;
  }

  std::shared_ptr<Core> core;
  Slot* slot;
};

SnapshotPool::SnapshotPool() : core_(std::make_shared<Core>()) {}

std::shared_ptr<MapSnapshot> SnapshotPool::acquire() {
  Slot* slot = nullptr;
  {
    const std::lock_guard lock(core_->mutex);
    if (core_->free.empty()) {
      core_->slots.push_back(std::make_unique<Slot>());
      core_->free.reserve(core_->slots.size());
      slot = core_->slots.back().get();
    } else {
      slot = core_->free.back();
      core_->free.pop_back();
    }
  }
  return {&slot->snapshot, [](MapSnapshot*) {}, InPlace<MapSnapshot>(core_, slot)};
}

std::size_t SnapshotPool::size() const {
  const std::lock_guard lock(core_->mutex);
  return core_->slots.size();
}

}  // namespace scree::mapping
