#include "node/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <pthread.h>
#include <string>
#include <thread>
#include <utility>

#include "node/udp_poses.hpp"

namespace scree::node {
namespace {

std::unique_ptr<PoseProvider> make_poses(const PipelineConfig& config, PoseInput& input) {
  const auto& pose = config.settings.pose;
  switch (pose.source) {
    case config::PoseSource::recording:
      return nullptr;
    case config::PoseSource::fixed:
      return std::make_unique<StaticPose>(pose.T_map_body);
    case config::PoseSource::udp:
      return std::make_unique<UdpPoses>(input, std::chrono::milliseconds(pose.max_age_ms), config.played);
  }
  return nullptr;
}

/// What an operator sees in top -H and a debugger.
template <class Body>
std::jthread named_thread(std::string name, Body body) {
  return std::jthread([name = std::move(name), body = std::move(body)](const std::stop_token& stop) {
    ::pthread_setname_np(::pthread_self(), name.c_str());
    body(stop);
  });
}

FrameQueue::Config queue_config(const PipelineConfig& config, std::size_t sources) {
  const auto& node = config.settings.node;
  const bool live = config.policy == QueuePolicy::newest_wins;
  return {config.policy, live ? 1 : static_cast<std::size_t>(node.queue_frames), sources,
          std::chrono::milliseconds(node.merge_ms)};
}

std::vector<std::string> names_in(const std::vector<NodeSource>& sources) {
  std::vector<std::string> names;
  for (const NodeSource& source : sources) names.push_back(source.name);
  return names;
}

}  // namespace

Pipeline::Pipeline(PipelineConfig config, std::vector<NodeSource> sources, std::unique_ptr<Inbox> inbox,
                   std::unique_ptr<Publisher> publisher, std::unique_ptr<Recorder> recorder)
    : config_(std::move(config)),
      names_(names_in(sources)),
      queue_(queue_config(config_, sources.size())),
      pool_(config_.settings.node.threads),
      inbox_(std::move(inbox)),
      poses_(make_poses(config_, inbox_->poses())),
      mapper_(config_.settings.map, pool_),
      publisher_(std::move(publisher)),
      recorder_(std::move(recorder)),
      source_states_(sources.size()),
      sources_(sources.size()) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    source_states_[i].statistics.name = sources[i].name;
    source_states_[i].last_frame = MonotonicClock::now();  // no sensor is late for what was built until now
    sources_[i].setup = std::move(sources[i]);
  }
  for (int i = 1; i < pool_.threads(); ++i)
    workers_.push_back(named_thread("scree-worker", [this](const std::stop_token& stop) { pool_.work(stop); }));
  if (recorder_) record_thread_ = named_thread("scree-record", [this](const std::stop_token&) { record(); });
  receive_thread_ = named_thread("scree-receive", [this](const std::stop_token& stop) { receive(stop); });
  publish_thread_ = named_thread("scree-publish", [this](const std::stop_token& stop) { publish(stop); });
  map_thread_ = named_thread("scree-map", [this](const std::stop_token&) { map_frames(stop_.get_token()); });
  const std::lock_guard lock(sources_mutex_);
  for (std::size_t i = 0; i < sources_.size(); ++i) start_source(i, std::move(sources_[i].setup.source));
  if (live()) supervise_thread_ = named_thread("scree-watch", [this](const std::stop_token& stop) { supervise(stop); });
}

Pipeline::~Pipeline() {
  request_stop();  // acquire and map; publish then ends by itself, and the workers' jthreads stop them
  if (supervise_thread_.joinable()) {
    supervise_thread_.request_stop();
    supervise_thread_.join();
  }
  end_sources();
}

/// Under sources_mutex_. Without a source the thread opens it.
void Pipeline::start_source(std::size_t index, std::unique_ptr<drivers::Source> source) {
  Acquired& acquired = sources_[index];
  acquired.run =
      std::make_shared<SourceRun>(acquired.setup, std::move(source), index, static_cast<SourceEvents&>(*this));
  acquired.thread = named_thread("scree-source" + std::to_string(index),
                                 [run = acquired.run](const std::stop_token& stop) { run->run(stop); });
}

void Pipeline::request_stop() {
  {
    const std::lock_guard lock(sources_mutex_);
    for (Acquired& acquired : sources_) acquired.thread.request_stop();
  }
  stop_.request_stop();
}

bool Pipeline::wait_finished(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [this] { return finished_ && (recorder_ == nullptr || recorded_); });
}

// ---- map ----

void Pipeline::map_frames(const std::stop_token& stop) {
  for (;;) {
    map_beat_.rest();
    const auto entry = queue_.pop(stop);
    if (entry.frame == nullptr) break;
    map_beat_.touch();
    note_first_frame();
    if (poses_ == nullptr) {
      map_frame(entry, *entry.frame);
    } else {
      posed_ = *entry.frame;
      if (place(stop)) map_frame(entry, posed_);
    }
  }
  if (recorder_) recorder_->close();
  const std::lock_guard lock(mutex_);
  map_ended_ = true;
  changed_.notify_all();
}

/// The poses of `posed_`; false when there are none that hold.
bool Pipeline::place(const std::stop_token& stop) {
  const bool fresh = poses_->provide(posed_, stop);
  map_beat_.touch();
  const std::lock_guard lock(mutex_);
  pose_stale_ = !fresh;
  statistics_.frames_pose_stale += fresh ? 0U : 1U;
  return fresh;
}

/// `frame` is that of `entry` with the poses to be used.
void Pipeline::map_frame(const FrameQueue::Entry& entry, const RangeFrame& frame) {
  const MonotonicTime taken = live() ? frame.received : MonotonicClock::now();
  const auto report = mapper_.step(frame);
  if (!report) {
    if (report.error().kind == ErrorKind::bad_data) return skipped(entry.source, report.error().message);
    fail(report.error(), true);
    return request_stop();
  }
  auto snapshot = mapper_.snapshot();
  const auto measured = snapshot != nullptr ? snapshot->measured_cells() : 0;
  drivers::Origin origin{};
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.frames_mapped;
    ++source_states_[entry.source].statistics.frames_mapped;
    statistics_.pixels += report->counts;
    statistics_.points_fused += report->points_fused;
    statistics_.points_outside += report->points_outside;
    statistics_.points_outlier += report->points_outlier;
    statistics_.points_other_surface += report->points_other_surface;
    statistics_.points_unsupported += report->points_unsupported;
    count_alignment(report->alignment);
    statistics_.cells_measured = measured;
    const auto now = MonotonicClock::now();
    latency_.add(now - taken);
    statistics_.mapping = now - *first_taken_;
    map_ = std::move(snapshot);
    map_taken_ = taken;
    origin = source_states_[entry.source].origin;
    report_pose(frame);
    changed_.notify_all();
  }
  if (recorder_) recorder_->add(entry.source, entry.frame, frame.T_map_body, frame.pose_variance, origin);
}

/// Under the lock.
void Pipeline::count_alignment(const mapping::AlignmentReport& alignment) {
  statistics_.pose_jumps += alignment.agreement == mapping::Agreement::jumped ? 1U : 0U;
  statistics_.frames_refused += alignment.refused ? 1U : 0U;
  statistics_.maps_forgotten += alignment.forgotten ? 1U : 0U;
  registration_m2_ += alignment.height_m * alignment.height_m;
  statistics_.registration_m = std::sqrt(registration_m2_ / static_cast<double>(statistics_.frames_mapped));
}

// ---- record ----

void Pipeline::record() {
  recorder_->run();
  const std::lock_guard lock(mutex_);
  recorded_ = true;
  changed_.notify_all();
}

// ---- publish ----

void Pipeline::publish(const std::stop_token& stop) {
  std::shared_ptr<const mapping::MapSnapshot> sent;
  for (;;) {
    publish_beat_.touch();
    take_requests();
    const auto now = MonotonicClock::now();
    const Duration next = publisher_->tick(now, status(now));
    copy_publisher_counters();
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, now + next, [&] {
      return map_ended_ || map_ != sent || next_pose_ < poses_out_.count() || !requests_.empty();
    });
    take_poses();
    if (map_ != sent) {
      sent = map_;
      const MonotonicTime taken = map_taken_;
      lock.unlock();
      publisher_->submit(sent, taken);
      lock.lock();
    }
    if ((map_ended_ && map_ == sent) || stop.stop_requested()) break;
  }
  publish_beat_.rest();  // what follows is bounded by the publisher's own limits
  if (const auto ended = publisher_->finish(status(MonotonicClock::now()), bye_reason(), [this] { take_requests(); });
      !ended) {
    const std::lock_guard lock(mutex_);
    publish_error_ = ended.error();
  }
  copy_publisher_counters();
  const std::lock_guard lock(mutex_);
  finished_ = true;
  changed_.notify_all();
}

void Pipeline::take_requests() {
  for (Request request; requests_.pop(request);) publisher_->handle(request, MonotonicClock::now());
}

/// Under the lock.
void Pipeline::take_poses() {
  if (next_pose_ < poses_out_.oldest()) {
    statistics_.poses_superseded += poses_out_.oldest() - next_pose_;
    next_pose_ = poses_out_.oldest();
  }
  for (; next_pose_ < poses_out_.count(); ++next_pose_) {
    const PoseLog::Entry& entry = poses_out_[next_pose_];
    publisher_->add_pose(entry.message, entry.delivered);
  }
}

// ---- receive ----

void Pipeline::receive(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kSlice{50};
  while (!stop.stop_requested()) {
    receive_beat_.touch();
    const auto requested = inbox_->poll(kSlice, requests_);
    if (!requested) {
      receive_beat_.rest();  // the fault is told: there is nothing more to watch
      return fail(requested.error(), true);
    }
    const InboxCounters counters = inbox_->counters();
    const std::lock_guard lock(mutex_);
    statistics_.inbox = counters;
    statistics_.requests_overflowed = requests_.overflowed();
    if (*requested) changed_.notify_all();
  }
}

}  // namespace scree::node
