#pragma once
// One source at work: what its thread does, and how it is given up when it hangs.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/source.hpp"
#include "node/pacer.hpp"

namespace scree::node {

using OpenSource = std::function<Result<std::unique_ptr<drivers::Source>>()>;

/// One source of a node, before it runs.
struct NodeSource {
  std::string name;                         ///< as configured
  std::unique_ptr<drivers::Source> source;  ///< open
  OpenSource open;                          ///< again; empty = never
  bool loop = false;                        ///< at the end of the stream begin again
  std::optional<double> rate;               ///< pace by data time; none = as fast as the source delivers
  /// A call into the source that does not return for so long is given up, and the source opened again; none = never.
  std::optional<Duration> deadline;
};

/// Where the threads of all sources put what comes; every call may come from any of them.
class SourceEvents {
 public:
  virtual ~SourceEvents() = default;
  /// False: nothing more is wanted.
  virtual bool frame(std::size_t source, std::shared_ptr<const RangeFrame> frame, drivers::Origin origin,
                     const std::stop_token& stop) = 0;
  virtual void skipped(std::size_t source, const std::string& message) = 0;
  virtual void notice(std::size_t source, const std::string& message) = 0;
  virtual void counters(std::size_t source, const drivers::SourceCounters& counters) = 0;
  /// The source can not go on. True: try again.
  virtual bool failed(std::size_t source, const Error& error) = 0;
  virtual void ended(std::size_t source) = 0;
};

/// Shared by the thread that runs it and the pipeline, so that a thread that never comes back may outlive the pipeline.
class SourceRun {
 public:
  /// `source` may be null: run() opens it. `setup.source` is not used.
  SourceRun(const NodeSource& setup, std::unique_ptr<drivers::Source> source, std::size_t index, SourceEvents& events);

  /// The body of the thread: until the stream ends, `stop`, or abandon().
  void run(const std::stop_token& stop);

  /// Nothing that it does is heard any more. Waits for an event that is being told.
  void abandon();

  /// Since when the thread is inside one call of its source; none = it is not. Any thread.
  std::optional<MonotonicTime> inside_since() const;
  /// run() has returned. Any thread.
  bool returned() const { return returned_; }

 private:
  class Inside;
  bool turn(const std::stop_token& stop);
  bool open_again(const std::stop_token& stop);
  bool take(drivers::SourceEvent event, const std::stop_token& stop);
  bool deliver(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop);
  bool begin_again();
  bool fail(const Error& error);

  const std::size_t index_;
  const OpenSource open_;
  const bool loop_;
  std::unique_ptr<drivers::Source> source_;
  Pacer pacer_;
  std::uint64_t frames_since_restart_ = 0;

  std::mutex gate_;  ///< guards events_, and is held while an event is told
  SourceEvents* events_;
  std::atomic<Duration::rep> inside_since_{0};  ///< of the monotonic clock; 0 = outside
  std::atomic<bool> returned_{false};
};

}  // namespace scree::node
