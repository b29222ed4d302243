#include "node/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/udp_poses.hpp"

namespace scree::node {
namespace {

constexpr std::chrono::milliseconds kSourceTimeout{100};

std::unique_ptr<PoseProvider> make_poses(const PipelineConfig& config, PoseInput& input) {
  const auto& pose = config.settings.pose;
  switch (pose.source) {
    case config::PoseSource::recording:
      return nullptr;
    case config::PoseSource::fixed:
      return std::make_unique<StaticPose>(pose.T_map_body);
    case config::PoseSource::udp:
      return std::make_unique<UdpPoses>(input, std::chrono::milliseconds(pose.max_age_ms), config.rate.has_value());
  }
  return nullptr;
}

}  // namespace

Pipeline::Pipeline(PipelineConfig config, std::unique_ptr<drivers::Source> source, std::unique_ptr<Inbox> inbox,
                   std::unique_ptr<Publisher> publisher)
    : config_(std::move(config)),
      source_(std::move(source)),
      pacer_(config_.rate),
      queue_(config_.policy, config_.policy == QueuePolicy::newest_wins
                                 ? 1
                                 : static_cast<std::size_t>(config_.settings.node.queue_frames)),
      pool_(config_.settings.node.threads),
      inbox_(std::move(inbox)),
      poses_(make_poses(config_, inbox_->poses())),
      mapper_(config_.settings.map, pool_),
      publisher_(std::move(publisher)),
      last_frame_(MonotonicClock::now()) {  // the sensor is not late for what was built until now
  for (int i = 1; i < pool_.threads(); ++i)
    workers_.emplace_back([this](const std::stop_token& stop) { pool_.work(stop); });
  receive_thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
  publish_thread_ = std::jthread([this](const std::stop_token& stop) { publish(stop); });
  map_thread_ = std::jthread([this] { map_frames(stop_.get_token()); });
  acquire_thread_ = std::jthread([this] { acquire(stop_.get_token()); });
}

Pipeline::~Pipeline() {
  request_stop();  // acquire and map; publish then ends by itself, and the workers' jthreads stop them
}

void Pipeline::request_stop() {
  stop_.request_stop();
}

bool Pipeline::wait_finished(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [this] { return finished_; });
}

// ---- acquire ----

void Pipeline::acquire(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto more = acquire_event(stop);
    if (!more) fail(more.error(), false);
    if (!more || !*more) break;
  }
  queue_.close();
  const std::lock_guard lock(mutex_);
  source_ended_ = true;
}

Result<bool> Pipeline::acquire_event(const std::stop_token& stop) {
  auto event = source_->next(kSourceTimeout);
  if (!event) return event.error();
  switch (event->kind) {
    case drivers::SourceEvent::Kind::timeout:
      return true;
    case drivers::SourceEvent::Kind::skipped:
      count_skipped(event->message);
      return true;
    case drivers::SourceEvent::Kind::frame:
      if (!event->message.empty()) spdlog::warn("frame taken: {}", event->message);
      return deliver(std::move(event->frame), stop);
    case drivers::SourceEvent::Kind::end_of_stream:
      return restart_source();
  }
  return false;
}

bool Pipeline::deliver(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop) {
  if (!pacer_.wait(frame->time, stop)) return false;
  if (pacer_.paced()) {  // it is "received" when it is released, not when it was read from the file
    auto released = std::make_shared<RangeFrame>(*frame);
    released->received = MonotonicClock::now();
    frame = std::move(released);
  }
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.frames_in;
    last_frame_ = MonotonicClock::now();
  }
  ++frames_since_restart_;
  return queue_.push(std::move(frame), stop);
}

/// An empty stream is not begun again: it would never end.
Result<bool> Pipeline::restart_source() {
  if (!config_.reopen || frames_since_restart_ == 0) return false;
  auto source = config_.reopen();
  if (!source) return source.error();
  source_ = *std::move(source);
  pacer_.restart();
  frames_since_restart_ = 0;
  return true;
}

// ---- map ----

void Pipeline::map_frames(const std::stop_token& stop) {
  while (const auto frame = queue_.pop(stop)) {
    note_first_frame();
    const MonotonicTime taken = config_.policy == QueuePolicy::newest_wins ? frame->received : MonotonicClock::now();
    if (poses_ == nullptr) {
      map_frame(*frame, taken, stop);
    } else {
      posed_ = *frame;
      map_frame(posed_, taken, stop);
    }
  }
  const std::lock_guard lock(mutex_);
  map_ended_ = true;
  changed_.notify_all();
}

void Pipeline::map_frame(const RangeFrame& frame, MonotonicTime taken, const std::stop_token& stop) {
  if (poses_ != nullptr) {
    const bool fresh = poses_->provide(posed_, stop);
    const std::lock_guard lock(mutex_);
    pose_stale_ = !fresh;
    if (!fresh) {
      ++statistics_.frames_pose_stale;
      return;
    }
  }
  const auto report = mapper_.step(frame);
  if (!report) {
    if (report.error().kind == ErrorKind::bad_data) return count_skipped(report.error().message);
    fail(report.error(), true);
    return request_stop();
  }
  auto snapshot = mapper_.snapshot();
  const auto measured = snapshot != nullptr ? snapshot->measured_cells() : 0;
  const std::lock_guard lock(mutex_);
  ++statistics_.frames_mapped;
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
  report_pose(frame);
  changed_.notify_all();
}

/// Under the lock.
void Pipeline::count_alignment(const mapping::AlignmentReport& alignment) {
  statistics_.pose_jumps += alignment.agreement == mapping::Agreement::jumped ? 1U : 0U;
  statistics_.frames_refused += alignment.refused ? 1U : 0U;
  statistics_.maps_forgotten += alignment.forgotten ? 1U : 0U;
  registration_m2_ += alignment.height_m * alignment.height_m;
  statistics_.registration_m = std::sqrt(registration_m2_ / static_cast<double>(statistics_.frames_mapped));
}

// ---- publish ----

void Pipeline::publish(const std::stop_token& stop) {
  std::shared_ptr<const mapping::MapSnapshot> sent;
  for (;;) {
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
    const auto requested = inbox_->poll(kSlice, requests_);
    if (!requested) return fail(requested.error(), true);
    const InboxCounters counters = inbox_->counters();
    const std::lock_guard lock(mutex_);
    statistics_.inbox = counters;
    statistics_.requests_overflowed = requests_.overflowed();
    if (*requested) changed_.notify_all();
  }
}

}  // namespace scree::node
