#pragma once
// Frames on their way from the sources' threads to map.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/time.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::node {

enum class QueuePolicy {
  lossless,     ///< replay: a full queue makes the producer wait
  newest_wins,  ///< live: a full queue loses its oldest frame, counted
};

/// When the last row of `frame` was taken.
Time end_time(const RangeFrame& frame);

/// A lane for each source. With several, live, pop() gives the frames in the order of their ends: it holds a frame back
/// as long as another source that is delivering may still bring an earlier one, judged by how late its frames came up
/// to now, and at most for `merge`. A frame that comes after a later one was given is dropped and counted as late.
/// Newest wins among the frames that need not be held any longer.
class FrameQueue {
 public:
  struct Config {
    QueuePolicy policy = QueuePolicy::lossless;
    std::size_t capacity = 1;  ///< of each lane; several live sources: kHeld
    std::size_t sources = 1;
    Duration merge{0};
  };
  struct Entry {
    std::shared_ptr<const RangeFrame> frame;  ///< null: there is none
    std::size_t source = 0;
  };
  enum class Pushed { taken, late, stopped };
  struct Losses {
    std::uint64_t dropped = 0;  ///< superseded by a newer one of the same source
    std::uint64_t late = 0;
  };

  /// Frames of one source that may be held back at a time: at 100 Hz those of 160 ms.
  static constexpr std::size_t kHeld = 16;

  explicit FrameQueue(const Config& config) : config_(config), lanes_(config.sources) {}

  /// Stopped: `stop` came while waiting for room. `now` is the system's clock, of which the frame's times are; when it
  /// is set back, what was given before counts no more.
  Pushed push(std::shared_ptr<const RangeFrame> frame, std::size_t source, Time now, const std::stop_token& stop);
  /// No frame when the queue is closed and empty, or on `stop`.
  Entry pop(const std::stop_token& stop);
  /// No frame will follow; what is in the queue still comes out.
  void close();

  /// Since when there is something to take that nobody has taken; none = nothing waits.
  std::optional<MonotonicTime> waiting_since() const;

  Losses losses(std::size_t source) const;
  std::uint64_t dropped() const;  ///< both kinds, of all sources

 private:
  struct Waiting {
    std::shared_ptr<const RangeFrame> frame;
    Time end;
    MonotonicTime arrival;
    Duration age{0};  ///< at its arrival
  };
  struct Lane {
    std::deque<Waiting> frames;
    std::optional<MonotonicTime> last_arrival;
    Duration interval{0};  ///< between the last two arrivals
    Duration lateness{0};  ///< age at arrival: the largest of late, slowly forgotten
    Losses losses;
  };
  std::optional<std::size_t> earliest() const;
  MonotonicTime due(std::size_t source, const Waiting& waiting) const;
  bool merges() const { return lanes_.size() > 1 && config_.policy == QueuePolicy::newest_wins; }
  void supersede(MonotonicTime now);
  bool is_late(Lane& lane);
  Entry take(std::size_t source);

  const Config config_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<Lane> lanes_;
  std::optional<Time> given_;  ///< end of the latest frame that was given
  std::optional<MonotonicTime> waiting_since_;
  bool closed_ = false;
};

}  // namespace scree::node
