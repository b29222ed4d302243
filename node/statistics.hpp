#pragma once
// What the node counted, as a line for the log and as JSON.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/source.hpp"
#include "node/inbox.hpp"
#include "node/publisher.hpp"
#include "node/recorder.hpp"

namespace scree::node {

/// What became of one source's frames.
struct SourceStatistics {
  std::string name;
  std::uint64_t frames_in = 0;
  std::uint64_t frames_skipped = 0;
  std::uint64_t frames_dropped = 0;  ///< superseded by a newer one of the same source
  std::uint64_t frames_late = 0;     ///< came after a later frame of another source was mapped
  std::uint64_t frames_mapped = 0;
  std::uint64_t failures = 0;        ///< errors after which it was opened again
  std::uint64_t abandoned = 0;       ///< calls that did not return in time: their thread was left behind
  drivers::SourceCounters counters;  ///< what it counts of its own
};

struct Statistics {
  std::uint64_t frames_in = 0;          ///< good frames that the source delivered
  std::uint64_t frames_skipped = 0;     ///< bad ones, which it could not read or which contradict their geometry
  std::uint64_t frames_dropped = 0;     ///< live: superseded before they were mapped, or late
  std::uint64_t frames_pose_stale = 0;  ///< no fresh pose: not integrated
  std::uint64_t frames_mapped = 0;
  PixelCounts pixels;  ///< of the frames mapped
  std::uint64_t points_fused = 0;
  std::uint64_t points_outside = 0;
  std::uint64_t points_outlier = 0;
  std::uint64_t points_other_surface = 0;  ///< overhang and the like, see docs/mapping.md
  std::uint64_t points_unsupported = 0;    ///< among points_outlier: alone above or below the ground around
  std::uint64_t pose_jumps = 0;            ///< frames whose pose jumped in height or tilt: the map followed
  std::uint64_t frames_refused = 0;        ///< mapped frames that contradicted the whole map and were not fused
  std::uint64_t maps_forgotten = 0;        ///< because two of them came in a row
  double registration_m = 0.0;             ///< rms height of the frames over the map before they were aligned
  std::uint64_t cells_measured = 0;        ///< in the last map
  Duration latency_p50{0};  ///< frame in to map out; replay: from the moment the map stage takes the frame
  Duration latency_p99{0};
  Duration latency_max{0};
  std::vector<SourceStatistics> sources;
  std::optional<RecorderCounters> recorder;  ///< none = nothing is recorded
  Duration latency_out_p50{0};               ///< the same to the last changed block out, at the configured destination
  Duration latency_out_p99{0};
  Duration latency_out_max{0};
  PublisherCounters publisher;
  SubscriptionCounters subscriptions;
  std::size_t subscribers = 0;            ///< at this moment
  InboxCounters inbox;                    ///< what came in
  std::uint64_t requests_overflowed = 0;  ///< of it, gone because the publisher did not keep up
  std::uint64_t poses_superseded = 0;     ///< of frames fused faster than they are published
  std::uint64_t health_changes = 0;       ///< times that a health bit was set
  Duration elapsed{0};                    ///< wall clock of the whole run, with start-up and the last map's way out
  /// From the moment the map stage took its first frame to the end of the last one that it mapped: what frames_per_s
  /// counts by.
  Duration mapping{0};

  /// Frames mapped per second of `mapping`; 0 before the first.
  double frames_per_s() const {
    return mapping.count() > 0 ? static_cast<double>(frames_mapped) / to_seconds(mapping) : 0.0;
  }
};

/// "frames 120 dropped 0 skipped 0 · map p50 3.1 p99 4.0 ms · cells 8123 · datagrams 4711"
std::string to_line(const Statistics& statistics);

/// One JSON object; `lost` is 0: a sender loses nothing.
std::string to_json(const Statistics& statistics);

}  // namespace scree::node
