#pragma once
// In which order one destination gets the units of the tile book.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "node/tile_book.hpp"

namespace scree::node {

/// A list of handles in which each is at most once. All operations but `reserve` are O(1) and allocate nothing.
class HandleList {
 public:
  void reserve(std::size_t handles) { links_.resize(std::max(handles, links_.size())); }
  bool empty() const { return first_ == kNone; }
  bool contains(UnitHandle handle) const { return handle < links_.size() && links_[handle].in; }
  UnitHandle front() const { return first_; }  ///< not of an empty list
  UnitHandle after(UnitHandle handle) const { return links_[handle].next; }
  static bool is_end(UnitHandle handle) { return handle == kNone; }
  void push_back(UnitHandle handle);  ///< not one that is in it
  void erase(UnitHandle handle);      ///< one that is in it
  std::size_t size() const { return size_; }

 private:
  static constexpr UnitHandle kNone = static_cast<UnitHandle>(-1);
  struct Link {
    UnitHandle previous = kNone;
    UnitHandle next = kNone;
    bool in = false;
  };
  std::vector<Link> links_;
  UnitHandle first_ = kNone;
  UnitHandle last_ = kNone;
  std::size_t size_ = 0;
};

/// Units are pending, first come first served, or were sent; of these some are still to be repeated. `generation`
/// counts maps: it tells since when a unit waits.
class SendQueue {
 public:
  /// Handles below `handles` may come. Allocates only when that grows.
  void reserve(std::size_t handles);

  bool contains(UnitHandle handle) const { return pending_.contains(handle) || sent_.contains(handle); }
  /// The unit is new or has new content. One that is pending already keeps its place. `blocks`: its datagrams.
  void change(UnitHandle handle, int blocks, std::uint64_t generation);
  void remove(UnitHandle handle);
  /// Asked for again: false when it is pending already.
  bool request(UnitHandle handle, std::uint64_t generation);
  /// Everything is to be sent once more.
  void mark_all_pending(std::uint64_t generation);

  bool has_pending() const { return !pending_.empty(); }
  /// The unit that waits longest, or the one that was sent longest ago.
  std::optional<UnitHandle> next_pending() const;
  std::optional<UnitHandle> least_recently_sent() const;
  /// Since which generation the longest waiting unit waits; none when none does.
  std::optional<std::uint64_t> pending_since() const;
  bool changed(UnitHandle handle) const { return state_[handle].changed; }
  bool requested(UnitHandle handle) const { return state_[handle].requested; }

  /// The unit (of either kind) was handed on; `repeats` more copies of it are due from `repeat_at`.
  void mark_sent(UnitHandle handle, int repeats, MonotonicTime repeat_at);

  /// The unit whose next copy is due first, if that is by `now`.
  std::optional<UnitHandle> next_repeat(MonotonicTime now) const;
  std::optional<MonotonicTime> repeat_due() const;
  /// The copy was handed on; the one after it, if any, is due at `next_at`.
  void mark_repeated(UnitHandle handle, MonotonicTime next_at);

  std::size_t units() const { return pending_.size() + sent_.size(); }
  /// Datagrams of all units, and of those that are pending (walks them).
  std::size_t blocks() const { return blocks_; }
  std::size_t pending_blocks() const;

 private:
  struct State {
    std::uint64_t since = 0;   ///< generation at which it became pending
    MonotonicTime repeat_at;   ///< of the next copy
    std::uint8_t blocks = 0;   ///< datagrams
    std::uint8_t repeats = 0;  ///< copies still to come
    bool changed = false;      ///< differs from what was last sent
    bool requested = false;    ///< pending because a client asked
  };
  void forget_repeats(UnitHandle handle);

  std::vector<State> state_;
  HandleList pending_;  // first = waits longest
  HandleList sent_;     // first = sent longest ago
  HandleList repeats_;  // first = due first: copies follow at one distance
  std::size_t blocks_ = 0;
};

}  // namespace scree::node
