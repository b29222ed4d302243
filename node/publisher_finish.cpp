// The end of a publisher: the newest map once more, its manifests, a last heartbeat, BYE. Waits for the pacing and for
// the kernel, and gives up only when nothing moves.

#include <algorithm>
#include <fmt/format.h>
#include <thread>

#include "node/publisher_state.hpp"

namespace scree::node {
namespace {

constexpr Duration kPatience = std::chrono::seconds(2);  // without any progress
constexpr Duration kNap = std::chrono::milliseconds(5);

}  // namespace

bool Publisher::State::wait_for_room(std::size_t datagrams) {
  MonotonicTime progress = MonotonicClock::now();
  for (;;) {
    const std::size_t before = fixed().outbox().room();
    fixed().flush(map);
    if (fixed().outbox().room() >= datagrams) return true;
    const MonotonicTime now = MonotonicClock::now();
    if (fixed().outbox().room() > before) progress = now;
    if (now - progress > kPatience) return false;
    std::this_thread::sleep_for(kNap);
  }
}

/// No refreshes and no manifests between the blocks: the pacing is theirs but for ten heartbeats and an announcement a
/// second, which keep the map valid at its receivers.
bool Publisher::State::send_pending(const std::function<void()>& between) {
  std::size_t waiting = fixed().queue().pending_blocks();
  MonotonicTime progress = MonotonicClock::now();
  for (;;) {
    if (between) between();
    const MonotonicTime now = MonotonicClock::now();
    map.look_at_system(now);
    expire_leases(now);
    bool others_wait = false;
    Duration nap = kNap;
    for (auto& stream : streams) {
      if (!stream) continue;
      stream->send_pending(now, map);
      others_wait = others_wait || stream->queue().has_pending();
      if (stream->queue().has_pending()) nap = std::min(nap, stream->until_worthwhile());
    }
    measure_latency(now);
    if (!others_wait) return true;
    if (const std::size_t left = fixed().queue().pending_blocks(); left != waiting) {
      waiting = left;
      progress = now;
    } else if (now - progress > kPatience) {
      return waiting == 0;  // it is only subscribers that are not done
    }
    std::this_thread::sleep_for(std::clamp<Duration>(nap, std::chrono::microseconds(200), kNap));
  }
}

void Publisher::State::send_last_manifests(bool& sent) {
  const MonotonicTime now = MonotonicClock::now();
  if (sent) sent = fixed().send_manifests(now, map, [this] { return wait_for_room(1); });
  for (std::size_t slot = 1; slot < streams.size(); ++slot)
    if (streams[slot]) streams[slot]->send_manifests(now, map, [&] { return streams[slot]->make_room(1, map); });
}

bool Publisher::State::send_farewell(protocol::ByeReason reason, bool patient) {
  const auto room = [&](MapStream& stream) {
    return &stream == &fixed() && patient ? wait_for_room(1) : stream.make_room(1, map);
  };
  for (auto& stream : streams)
    if (stream && room(*stream)) stream->send_heartbeat(MonotonicClock::now(), map);
  int copies = 0;
  for (int copy = 0; copy < 3; ++copy) {
    if (copy > 0) std::this_thread::sleep_for(kNap);
    for (auto& stream : streams) {
      if (!stream || !room(*stream)) continue;
      stream->send_bye(MonotonicClock::now(), map, reason, copy);
      stream->flush(map);
      copies += &*stream == &fixed() ? 1 : 0;
    }
  }
  return copies == 3 && (patient ? wait_for_room(Outbox::kCapacity) : fixed().outbox().empty());
}

Status Publisher::finish(const NodeStatus& status, protocol::ByeReason reason, const std::function<void()>& between) {
  State& s = *state_;
  s.map.status = status;
  for (auto& stream : s.streams)
    if (stream) stream->send_all_again(s.map);
  bool sent = s.send_pending(between);
  if (s.map.has_map) s.send_last_manifests(sent);
  sent = s.send_farewell(reason, sent) && sent;
  s.measure_latency(MonotonicClock::now());
  s.map.counters.cells_saturated = s.map.book.quantisation().saturated;
  if (error()) return *error();
  if (sent) return {};
  const SendQueue& queue = s.fixed().queue();
  return Error{ErrorKind::io,
               fmt::format("publish.destination {}: expected to send the last map and BYE, found that for {} s nothing "
                           "could be sent ({} of {} blocks and {} datagrams waiting)",
                           s.map.settings.destination, to_seconds(kPatience), queue.pending_blocks(), queue.blocks(),
                           Outbox::kCapacity - s.fixed().outbox().room())};
}

}  // namespace scree::node
