#pragma once
// The process in one place: acquire → map → publish, each a thread, from a Source to the network.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "drivers/source.hpp"
#include "mapping/mapper.hpp"
#include "node/frame_queue.hpp"
#include "node/latency.hpp"
#include "node/pacer.hpp"
#include "node/pose_input.hpp"
#include "node/pose_provider.hpp"
#include "node/publisher.hpp"
#include "node/statistics.hpp"
#include "node/worker_pool.hpp"

namespace scree::node {

struct PipelineConfig {
  config::Settings settings;
  QueuePolicy policy = QueuePolicy::lossless;
  std::optional<double> rate;  ///< pace by data time; none = as fast as the source delivers
  /// Set: at the end of the stream begin again with what this opens.
  std::function<Result<std::unique_ptr<drivers::Source>>()> reopen;
};

/// Threads: acquire owns the source, map owns the Mapper, publish owns the Publisher. Every wait takes the stop token.
/// Lossless, the same frames give the same map at any rate and with any number of threads.
class Pipeline {
 public:
  /// Starts the threads.
  Pipeline(PipelineConfig config, std::unique_ptr<drivers::Source> source, std::unique_ptr<PoseInput> input,
           std::unique_ptr<Publisher> publisher);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Ends acquiring and mapping after the frame at hand; the map so far is still published and ended with BYE.
  void request_stop();

  /// Waits for the end (stream exhausted or stopped, last map sent); false after `timeout`.
  bool wait_finished(std::chrono::milliseconds timeout);

  Statistics statistics() const;
  /// The last map; null before the first.
  std::shared_ptr<const mapping::MapSnapshot> map() const;
  /// What ended the stream early, if anything did.
  std::optional<Error> error() const;
  /// Why the last map could not be sent, if it could not; map() is complete all the same.
  std::optional<Error> publish_error() const;

 private:
  void acquire(const std::stop_token& stop);
  Result<bool> acquire_event(const std::stop_token& stop);  ///< false: nothing more will come
  bool deliver(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop);
  void copy_source_counters();
  Result<bool> restart_source();
  void map_frames(const std::stop_token& stop);
  void count_alignment(const mapping::AlignmentReport& alignment);
  void map_frame(const RangeFrame& frame, MonotonicTime taken, const std::stop_token& stop);
  void publish(const std::stop_token& stop);
  bool poses_come_by_udp() const { return config_.settings.pose.source == config::PoseSource::udp; }
  protocol::ByeReason bye_reason() const;
  void count_rejected();
  void note_first_frame();
  void copy_publisher_counters();
  NodeStatus status(MonotonicTime now);
  void count_skipped(const std::string& message);
  void fail(Error error);

  const PipelineConfig config_;
  const MonotonicTime start_ = MonotonicClock::now();
  std::unique_ptr<drivers::Source> source_;  ///< acquire thread
  Pacer pacer_;
  std::uint64_t frames_since_restart_ = 0;
  FrameQueue queue_;
  WorkerPool pool_;
  std::unique_ptr<PoseInput> input_;     ///< map thread with pose.source udp, else publish thread
  std::unique_ptr<PoseProvider> poses_;  ///< map thread; null = the frames' own
  mapping::Mapper mapper_;
  RangeFrame posed_;                      ///< a frame with its poses replaced, kept for its allocation
  std::unique_ptr<Publisher> publisher_;  ///< publish thread

  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable_any changed_;
  Statistics statistics_;
  std::optional<drivers::Origin> origin_;  ///< of the last frame delivered
  double registration_m2_ = 0.0;           // sum of squares over the frames mapped
  LatencyHistogram latency_;
  std::optional<MonotonicTime> first_taken_;  ///< by the map stage
  std::shared_ptr<const mapping::MapSnapshot> map_;
  std::optional<Error> error_;
  std::optional<Error> publish_error_;
  MonotonicTime last_frame_ = start_;
  std::uint64_t dropped_at_last_look_ = 0;
  MonotonicTime last_look_ = start_;
  bool overloaded_ = false;
  bool pose_stale_ = false;
  bool source_ended_ = false;
  bool map_ended_ = false;
  bool finished_ = false;

  std::stop_source stop_;  ///< of acquire and map

  std::vector<std::jthread> workers_;  // threads last: they end before anything they use
  std::jthread publish_thread_;
  std::jthread map_thread_;
  std::jthread acquire_thread_;
};

}  // namespace scree::node
