#include "node/send_queue.hpp"

#include <cassert>

namespace scree::node {

void HandleList::push_back(UnitHandle handle) {
  assert(!contains(handle));
  links_[handle] = {last_, kNone, true};
  (last_ == kNone ? first_ : links_[last_].next) = handle;
  last_ = handle;
  ++size_;
}

void HandleList::erase(UnitHandle handle) {
  assert(contains(handle));
  const Link link = links_[handle];
  (link.previous == kNone ? first_ : links_[link.previous].next) = link.next;
  (link.next == kNone ? last_ : links_[link.next].previous) = link.previous;
  links_[handle] = {};
  --size_;
}

void SendQueue::reserve(std::size_t handles) {
  if (handles <= state_.size()) return;
  state_.resize(handles);
  pending_.reserve(handles);
  sent_.reserve(handles);
  repeats_.reserve(handles);
}

void SendQueue::change(UnitHandle handle, int blocks, std::uint64_t generation) {
  State& state = state_[handle];
  if (!contains(handle)) {
    state = {};
    state.blocks = static_cast<std::uint8_t>(blocks);
    blocks_ += state.blocks;
  }
  forget_repeats(handle);  // of what is no longer true
  state.changed = true;
  if (pending_.contains(handle)) return;
  if (sent_.contains(handle)) sent_.erase(handle);
  state.since = generation;
  pending_.push_back(handle);
}

void SendQueue::remove(UnitHandle handle) {
  if (!contains(handle)) return;
  forget_repeats(handle);
  (pending_.contains(handle) ? pending_ : sent_).erase(handle);
  blocks_ -= state_[handle].blocks;
  state_[handle] = {};
}

bool SendQueue::request(UnitHandle handle, std::uint64_t generation) {
  if (!sent_.contains(handle)) return false;
  sent_.erase(handle);
  state_[handle].since = generation;
  state_[handle].requested = true;
  pending_.push_back(handle);
  return true;
}

void SendQueue::mark_all_pending(std::uint64_t generation) {
  while (!sent_.empty()) {
    const UnitHandle handle = sent_.front();
    sent_.erase(handle);
    state_[handle].since = generation;
    pending_.push_back(handle);
  }
}

std::optional<UnitHandle> SendQueue::next_pending() const {
  return pending_.empty() ? std::nullopt : std::optional(pending_.front());
}

std::optional<UnitHandle> SendQueue::least_recently_sent() const {
  return sent_.empty() ? std::nullopt : std::optional(sent_.front());
}

std::optional<std::uint64_t> SendQueue::pending_since() const {
  return pending_.empty() ? std::nullopt : std::optional(state_[pending_.front()].since);
}

void SendQueue::mark_sent(UnitHandle handle, int repeats, MonotonicTime repeat_at) {
  State& state = state_[handle];
  (pending_.contains(handle) ? pending_ : sent_).erase(handle);
  sent_.push_back(handle);
  state.changed = false;
  state.requested = false;
  if (repeats <= 0) return;
  forget_repeats(handle);
  state.repeats = static_cast<std::uint8_t>(repeats);
  state.repeat_at = repeat_at;
  repeats_.push_back(handle);
}

std::optional<MonotonicTime> SendQueue::repeat_due() const {
  return repeats_.empty() ? std::nullopt : std::optional(state_[repeats_.front()].repeat_at);
}

std::optional<UnitHandle> SendQueue::next_repeat(MonotonicTime now) const {
  const auto due = repeat_due();
  return due && *due <= now ? std::optional(repeats_.front()) : std::nullopt;
}

void SendQueue::mark_repeated(UnitHandle handle, MonotonicTime next_at) {
  State& state = state_[handle];
  repeats_.erase(handle);
  if (--state.repeats == 0) return;
  state.repeat_at = next_at;
  repeats_.push_back(handle);
}

void SendQueue::forget_repeats(UnitHandle handle) {
  if (repeats_.contains(handle)) repeats_.erase(handle);
  state_[handle].repeats = 0;
}

std::size_t SendQueue::pending_blocks() const {
  std::size_t count = 0;
  if (pending_.empty()) return count;
  for (UnitHandle handle = pending_.front(); !HandleList::is_end(handle); handle = pending_.after(handle))
    count += state_[handle].blocks;
  return count;
}

}  // namespace scree::node
