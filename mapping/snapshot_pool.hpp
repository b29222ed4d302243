#pragma once
// Snapshots that reuse their buffers.

#include <memory>

#include "mapping/snapshot.hpp"

namespace scree::mapping {

/// Hands out snapshots; the last reader that lets go of one, on any thread, gives its buffers back. The control block
/// of the shared_ptr lives beside the snapshot, so nothing is allocated once as many snapshots exist as are held at
/// the same time. The pool may die before its snapshots.
class SnapshotPool {
 public:
  SnapshotPool();
  /// A snapshot with the contents of some earlier one: the caller sets every member.
  std::shared_ptr<MapSnapshot> acquire();
  /// Snapshots ever made.
  std::size_t size() const;

 private:
  struct Core;
  struct Slot;
  template <class T>
  struct InPlace;
  std::shared_ptr<Core> core_;
};

}  // namespace scree::mapping
