// The end of a publisher: the newest map once more, its manifests, a last heartbeat, BYE. Waits for the pacing and for
// the kernel, and gives up only when nothing moves.

#include <fmt/format.h>
#include <thread>

#include "node/publisher_schedule.hpp"

namespace scree::node {
namespace {

constexpr Duration kPatience = std::chrono::seconds(2);  // without any progress
constexpr Duration kNap = std::chrono::milliseconds(5);

}  // namespace

bool Publisher::State::wait_for_room(std::size_t datagrams) {
  MonotonicTime progress = MonotonicClock::now();
  for (;;) {
    const std::size_t before = outbox.room();
    outbox.flush();
    if (outbox.room() >= datagrams) return true;
    const MonotonicTime now = MonotonicClock::now();
    if (outbox.room() > before) progress = now;
    if (now - progress > kPatience) return false;
    std::this_thread::sleep_for(kNap);
  }
}

/// No refreshes and no manifests between the blocks: the pacing is theirs but for ten heartbeats and an announcement a
/// second, which keep the map valid at its receivers.
bool Publisher::State::send_pending() {
  std::uint64_t blocks = counters.blocks;
  MonotonicTime progress = MonotonicClock::now();
  while (book.has_pending()) {
    const MonotonicTime now = MonotonicClock::now();
    bucket.refill(now);
    if (outbox.flush()) {
      send_periodic(now);
      while (book.has_pending() && bucket.has_token() && make_room(2)) send_unit(now, *book.next_pending());
      outbox.flush();
    }
    if (counters.blocks != blocks) {
      blocks = counters.blocks;
      progress = now;
    } else if (now - progress > kPatience) {
      return false;
    }
    std::this_thread::sleep_for(std::clamp<Duration>(bucket.until_worthwhile(), std::chrono::microseconds(200), kNap));
  }
  return true;
}

bool Publisher::State::send_farewell(protocol::ByeReason reason, bool patient) {
  const auto room = [&] { return patient ? wait_for_room(1) : make_room(1); };
  if (room()) send_heartbeat(MonotonicClock::now());
  int copies = 0;
  for (int copy = 0; copy < 3; ++copy) {
    if (copy > 0) std::this_thread::sleep_for(kNap);
    if (room()) send_bye(MonotonicClock::now(), reason, copies++);
    outbox.flush();
  }
  return copies == 3 && (patient ? wait_for_room(Outbox::kCapacity) : outbox.empty());
}

Status Publisher::finish(const NodeStatus& status, protocol::ByeReason reason) {
  State& s = *state_;
  s.status = status;
  s.book.mark_all_pending();
  s.next_announce = {};  // a receiver must know the window before the last tiles come
  bool sent = s.send_pending();
  if (sent && s.has_map) sent = s.send_manifests(MonotonicClock::now(), [&s] { return s.wait_for_room(1); });
  sent = s.send_farewell(reason, sent) && sent;
  s.collect_counters();
  if (s.outbox.error()) return *s.outbox.error();
  if (sent) return {};
  return Error{ErrorKind::io,
               fmt::format("publish.destination {}: expected to send the last map and BYE, found that for {} s nothing "
                           "could be sent ({} of {} blocks and {} datagrams waiting)",
                           s.settings.destination, to_seconds(kPatience), s.book.pending_blocks(), s.book.blocks(),
                           Outbox::kCapacity - s.outbox.room())};
}

}  // namespace scree::node
