#pragma once
// The process in one place: acquire → map → publish, each a thread, from Sources to the network.

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "drivers/source.hpp"
#include "mapping/mapper.hpp"
#include "node/beat.hpp"
#include "node/frame_queue.hpp"
#include "node/health.hpp"
#include "node/inbox.hpp"
#include "node/latency.hpp"
#include "node/pose_provider.hpp"
#include "node/publisher.hpp"
#include "node/recorder.hpp"
#include "node/requests.hpp"
#include "node/source_run.hpp"
#include "node/statistics.hpp"
#include "node/worker_pool.hpp"

namespace scree::node {

struct PipelineConfig {
  config::Settings settings;
  QueuePolicy policy = QueuePolicy::lossless;
  bool played = false;  ///< frames have the clock of a recording, not the node's
};

/// Threads: one for each source, map owns the Mapper, publish owns the Publisher, receive reads what comes in,
/// supervise gives up sources that hang, record writes. Every wait takes a stop token or is short. Lossless, the same
/// frames give the same map at any rate and with any number of threads.
class Pipeline final : private SourceEvents {
 public:
  /// Starts the threads. At least one source; lossless with exactly one. `recorder` may be null.
  Pipeline(PipelineConfig config, std::vector<NodeSource> sources, std::unique_ptr<Inbox> inbox,
           std::unique_ptr<Publisher> publisher, std::unique_ptr<Recorder> recorder);
  ~Pipeline() override;
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Ends acquiring and mapping after the frame at hand; the map so far is still published and ended with BYE.
  void request_stop();

  /// Waits for the end (streams exhausted or stopped, last map sent, recording closed); false after `timeout`.
  bool wait_finished(std::chrono::milliseconds timeout);

  Statistics statistics() const;
  /// The last map; null before the first.
  std::shared_ptr<const mapping::MapSnapshot> map() const;
  /// What ended the stream early, if anything did.
  std::optional<Error> error() const;
  /// Why the last map could not be sent, if it could not; map() is complete all the same.
  std::optional<Error> publish_error() const;
  /// The stage that has not advanced for `limit`; empty = all do. A source that hangs is not one: it is given up.
  std::string stalled(Duration limit) const;

 private:
  struct Acquired {
    NodeSource setup;
    std::shared_ptr<SourceRun> run;
    std::jthread thread;
    std::optional<MonotonicTime> inside_since;  ///< as the supervisor saw it last …
    int rounds = 0;                             ///< … and how often in a row
  };
  /// What the pipeline knows of a source.
  struct SourceState {
    SourceStatistics statistics;
    MonotonicTime last_frame;  ///< that came in time
    std::uint64_t late_in_a_row = 0;
    drivers::Origin origin = drivers::Origin::live;
    bool has_frame = false;
    bool ended = false;
  };

  // acquire: of the sources' threads (pipeline_acquire.cpp)
  bool frame(std::size_t source, std::shared_ptr<const RangeFrame> frame, drivers::Origin origin,
             const std::stop_token& stop) override;
  void skipped(std::size_t source, const std::string& message) override;
  void notice(std::size_t source, const std::string& message) override;
  void counters(std::size_t source, const drivers::SourceCounters& counters) override;
  bool failed(std::size_t source, const Error& error) override;
  void ended(std::size_t source) override;
  void start_source(std::size_t index, std::unique_ptr<drivers::Source> source);
  void supervise(const std::stop_token& stop);
  void look_after(std::size_t index);
  void give_up(const std::string& source);
  void note_late(std::size_t source, Duration age);
  void bury_abandoned();
  void end_sources();

  void map_frames(const std::stop_token& stop);
  void count_alignment(const mapping::AlignmentReport& alignment);
  void map_frame(const FrameQueue::Entry& entry, const RangeFrame& frame);
  bool place(const std::stop_token& stop);
  void record();
  void report_pose(const RangeFrame& frame);  ///< under the lock
  void publish(const std::stop_token& stop);
  void take_requests();
  void take_poses();
  void receive(const std::stop_token& stop);
  bool live() const { return config_.policy == QueuePolicy::newest_wins; }
  bool poses_come_by_udp() const { return config_.settings.pose.source == config::PoseSource::udp; }
  protocol::ByeReason bye_reason() const;
  void note_first_frame();
  void copy_publisher_counters();
  NodeStatus status(MonotonicTime now);
  void judge_sensors(NodeStatus& status, Condition& condition);  ///< under the lock
  void tell_sensors(const NodeStatus& status);
  bool recording_is_incomplete();
  void fail(Error error, bool fault);  ///< `fault`: of the node itself, not of its source

  const PipelineConfig config_;
  const std::vector<std::string> names_;  ///< of the sources
  const MonotonicTime start_ = MonotonicClock::now();
  FrameQueue queue_;
  WorkerPool pool_;
  std::unique_ptr<Inbox> inbox_;         ///< receive thread; its poses are shared
  RequestQueue requests_;                ///< receive → publish
  std::unique_ptr<PoseProvider> poses_;  ///< map thread; null = the frames' own
  mapping::Mapper mapper_;
  RangeFrame posed_;                      ///< a frame with its poses replaced, kept for its allocation
  std::unique_ptr<Publisher> publisher_;  ///< publish thread, as the two below
  HealthState health_;
  std::uint64_t next_pose_ = 0;  ///< of those below to be handed to the publisher
  std::unique_ptr<Recorder> recorder_;
  std::uint64_t recording_lost_ = 0;                                 ///< frames, when the publish thread looked last
  std::array<protocol::SensorState, protocol::kMaxSensors> told_{};  ///< by the publish thread

  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable_any changed_;
  Statistics statistics_;
  double registration_m2_ = 0.0;  // sum of squares over the frames mapped
  LatencyHistogram latency_;
  std::optional<MonotonicTime> first_taken_;  ///< by the map stage
  std::shared_ptr<const mapping::MapSnapshot> map_;
  std::optional<Error> error_;
  std::optional<Error> publish_error_;
  std::vector<SourceState> source_states_;
  std::optional<drivers::Origin> origin_;  ///< of the frames up to now: the least live of them
  PoseLog poses_out_;                      ///< of the frames fused
  MonotonicTime map_taken_;                ///< when the map stage's frame of `map_` came in
  bool pose_stale_ = false;
  bool faulty_ = false;
  bool gave_up_ = false;  ///< too many threads were left behind
  bool map_ended_ = false;
  bool recorded_ = false;
  bool finished_ = false;

  std::stop_source stop_;  ///< of map
  Beat map_beat_, publish_beat_, receive_beat_, supervise_beat_;

  std::mutex sources_mutex_;  ///< guards the two below; taken before mutex_
  std::vector<Acquired> sources_;
  std::vector<Acquired> abandoned_;  ///< threads that are inside a call which does not return

  std::vector<std::jthread> workers_;  // threads last: they end before anything they use
  std::jthread record_thread_;
  std::jthread receive_thread_;
  std::jthread publish_thread_;
  std::jthread map_thread_;
  std::jthread supervise_thread_;
};

}  // namespace scree::node
