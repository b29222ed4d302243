#include "node/recorder.hpp"

#include <chrono>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <system_error>
#include <utility>

#include "config/recording_file.hpp"
#include "drivers/line_file.hpp"
#include "drivers/table.hpp"

namespace scree::node {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{500};
constexpr std::uint64_t kRefusalsShown = 10;

}  // namespace

/// order.csv of a node with several sources.
class Recorder::Order {
 public:
  Status add(const drivers::OrderRow& row) { return file_.write(drivers::format_order_row(row)); }
  Status open(const std::filesystem::path& directory) {
    if (auto opened = file_.open(directory / "order.csv"); !opened) return opened;
    return file_.write(std::string(drivers::kOrderHeader) + "\n");
  }
  Status close() { return file_.close(); }

 private:
  drivers::LineFile file_;
};

Recorder::Recorder(std::filesystem::path directory, const config::RecordSettings& settings,
                   const std::vector<std::string>& sources)
    : directory_(std::move(directory)),
      sources_(sources),
      keep_free_bytes_(static_cast<std::uint64_t>(settings.keep_free_mb) * 1'000'000),
      queue_(static_cast<std::size_t>(settings.queue_frames)) {
  const bool several = sources_.size() > 1;
  for (const std::string& source : sources_)
    recordings_.emplace_back(several ? directory_ / source : directory_, config::write_recording);
}

Recorder::~Recorder() = default;

Result<std::unique_ptr<Recorder>> Recorder::open(const std::string& directory, const config::RecordSettings& settings,
                                                 const std::vector<std::string>& sources) {
  if (const auto claimed = drivers::claim_directory(directory); !claimed) return claimed.error();
  std::unique_ptr<Recorder> recorder(new Recorder(directory, settings, sources));
  if (const auto room = recorder->keep_free(); !room) return Error{ErrorKind::cannot_create, room.error().message};
  if (sources.size() > 1) {
    recorder->order_ = std::make_unique<Order>();
    if (const auto opened = recorder->order_->open(directory); !opened) return opened.error();
  }
  return recorder;
}

void Recorder::add(std::size_t source, std::shared_ptr<const RangeFrame> frame, const std::vector<Pose>& T_map_body,
                   const PoseVariance& variance, drivers::Origin origin) {
  {
    const std::lock_guard lock(mutex_);
    if (size_ == queue_.size() || counters_.failed) {
      ++counters_.dropped;
      return;
    }
    Item& item = queue_[(first_ + size_++) % queue_.size()];
    item.source = source;
    item.frame = std::move(frame);
    item.T_map_body.assign(T_map_body.begin(), T_map_body.end());
    item.variance = variance;
    item.origin = origin;
  }
  changed_.notify_one();
}

void Recorder::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_one();
}

/// False: the queue is closed and empty.
bool Recorder::pop(Item& item) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || size_ > 0; });
  if (size_ == 0) return false;
  std::swap(item, queue_[first_]);
  queue_[first_].frame.reset();  // back to its pool
  first_ = (first_ + 1) % queue_.size();
  --size_;
  return true;
}

void Recorder::run() {
  Item item;
  while (pop(item)) {
    write(item);
    item.frame.reset();
  }
  for (auto& recording : recordings_)
    if (const auto finished = recording.finish(); !finished) fail(finished.error());
  if (order_)
    if (const auto closed = order_->close(); !closed) fail(closed.error());
}

void Recorder::write(const Item& item) {
  if (counters().failed) {
    const std::lock_guard lock(mutex_);
    ++counters_.dropped;
    return;
  }
  const Status written = write_frame(item);
  const bool fits = written || written.error().kind == ErrorKind::bad_data;
  if (!fits) fail(written.error());
  std::uint64_t refused = 0;
  {
    const std::lock_guard lock(mutex_);
    counters_.frames += written ? 1U : 0U;
    counters_.dropped += fits ? 0U : 1U;
    refused = counters_.refused += fits && !written ? 1U : 0U;
    counters_.restamped = 0;
    for (const auto& recording : recordings_) counters_.restamped += recording.restamped();
  }
  if (!fits || written) return;
  if (refused <= kRefusalsShown) spdlog::warn("not recorded: {}", written.error().message);
  if (refused == kRefusalsShown) spdlog::warn("further frames that are not recorded are only counted");
}

Status Recorder::write_frame(const Item& item) {
  if (auto room = keep_free(); !room) return room;
  drivers::LiveRecording& recording = recordings_[item.source];
  if (auto added = recording.add({*item.frame, item.T_map_body, item.variance, item.origin}); !added) return added;
  return order_ ? order_->add({sources_[item.source], recording.frames() - 1}) : Status{};
}

/// Looks at the disk twice a second: a robot needs what is left of it for other things.
Status Recorder::keep_free() {
  const auto now = MonotonicClock::now();
  if (keep_free_bytes_ == 0 || now < next_look_) return {};
  next_look_ = now + kBetweenLooks;
  std::error_code failed;
  const auto space = std::filesystem::space(directory_, failed);
  if (failed || space.available >= keep_free_bytes_) return {};
  return Error{ErrorKind::io,
               fmt::format("{}: expected more than {} MB free (record.keep_free_mb), found {} MB", directory_.string(),
                           keep_free_bytes_ / 1'000'000, space.available / 1'000'000)};
}

void Recorder::fail(const Error& error) {
  spdlog::error("recording ended, the map goes on: {}", error.message);
  const std::lock_guard lock(mutex_);
  counters_.failed = true;
}

RecorderCounters Recorder::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace scree::node
