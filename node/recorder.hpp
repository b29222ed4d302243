#pragma once
// Recording what is mapped, beside the mapping: a bounded queue and a thread of its own.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "drivers/live_recording.hpp"

namespace scree::node {

struct RecorderCounters {
  std::uint64_t frames = 0;     ///< written
  std::uint64_t dropped = 0;    ///< mapped while the queue was full, or after the recording had failed
  std::uint64_t refused = 0;    ///< that the format cannot hold
  std::uint64_t restamped = 0;  ///< of the written ones, see LiveRecording
  bool failed = false;          ///< the recording ended early: a full disk and the like
};

/// One source: `directory` is its recording. Several: a folder for each, named as it is, and order.csv. When nothing
/// was dropped or refused, a replay gives the same map, byte for byte.
class Recorder {
 public:
  /// Claims the directory. `settings` without sources has one. Errors: cannot_create.
  static Result<std::unique_ptr<Recorder>> open(const std::string& directory, const config::RecordSettings& settings,
                                                const std::vector<std::string>& sources);
  ~Recorder();

  /// A frame that was just mapped, with the poses it was mapped with. Never waits; no allocation once each place of the
  /// queue was used. Map thread.
  void add(std::size_t source, std::shared_ptr<const RangeFrame> frame, const std::vector<Pose>& T_map_body,
           const PoseVariance& variance, drivers::Origin origin);
  /// No frame will follow; run() returns when the rest is written.
  void close();

  /// The body of the recorder's thread. After a failure it goes on to empty the queue into nothing.
  void run();

  RecorderCounters counters() const;

 private:
  struct Item {
    std::size_t source = 0;
    std::shared_ptr<const RangeFrame> frame;
    std::vector<Pose> T_map_body;
    PoseVariance variance;
    drivers::Origin origin = drivers::Origin::live;
  };
  class Order;
  Recorder(std::filesystem::path directory, const config::RecordSettings& settings,
           const std::vector<std::string>& sources);
  bool pop(Item& item);
  void write(const Item& item);
  Status write_frame(const Item& item);
  Status keep_free();
  void fail(const Error& error);

  const std::filesystem::path directory_;
  const std::vector<std::string> sources_;
  const std::uint64_t keep_free_bytes_;
  std::vector<drivers::LiveRecording> recordings_;  ///< recorder thread
  std::unique_ptr<Order> order_;                    ///< recorder thread; null with one source
  MonotonicTime next_look_{};                       ///< at the disk

  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  std::vector<Item> queue_;  ///< a ring
  std::size_t first_ = 0, size_ = 0;
  bool closed_ = false;
  RecorderCounters counters_;
};

}  // namespace scree::node
