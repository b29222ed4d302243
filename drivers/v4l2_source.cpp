#include "drivers/v4l2_source.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <thread>
#include <utility>

#include "drivers/frame_pool.hpp"
#include "drivers/v4l2_device.hpp"
#include "drivers/v4l2_frame.hpp"

namespace scree::drivers {
namespace {

/// A device that is plugged in again is to give frames within 2 s; looking whether its node is there costs nothing.
constexpr std::chrono::milliseconds kLastReopen{1000};
constexpr int kSettles = 3;  ///< first waits between a loss and closing what was lost

using std::chrono::milliseconds;
using Happened = Result<std::optional<SourceEvent>>;  ///< nothing, an event, or a fault of the configuration

class V4l2Source final : public Source {
 public:
  V4l2Source(V4l2SourceConfig config, const v4l2::Wanted& wanted)
      : config_(std::move(config)),
        wanted_(wanted),
        name_("v4l2 " + config_.device),
        retry_(config_.first_retry, kLastReopen),
        maker_(config_.sensor) {}

  Result<SourceEvent> next(milliseconds timeout) override {
    const MonotonicTime deadline = MonotonicClock::now() + timeout;
    for (;;) {
      const auto now = MonotonicClock::now();
      auto happened = device_ ? receive(now, deadline) : open(now, deadline);
      if (!happened) return happened.error();
      if (*happened) return **std::move(happened);
      if (MonotonicClock::now() >= deadline) return SourceEvent{SourceEvent::Kind::timeout, nullptr, {}};
    }
  }

  Origin origin() const override { return config_.origin; }
  std::string name() const override { return name_; }

  SourceCounters counters() const override {
    SourceCounters out;
    out.add("frames", frames_);
    out.add("flagged", flagged_);
    out.add("short", short_);
    out.add("frames_missing", sequence_.missing());
    out.add("arrival_times", arrival_times_ + maker_.clock().implausible());
    out.add("clock_held", maker_.clock().held());
    out.add("connections", connections_);
    out.add("losses", losses_);
    out.add("silences", silences_);
    return out;
  }

 private:
  std::optional<SourceEvent> event(SourceEvent::Kind kind, const std::string& what) const {
    return SourceEvent{kind, nullptr, fmt::format("{}: {}", name_, what)};
  }

  Happened open(MonotonicTime now, MonotonicTime deadline) {
    if (now < retry_.at()) {
      std::this_thread::sleep_until(std::min(retry_.at(), deadline));
      return std::optional<SourceEvent>();
    }
    auto opened = v4l2::Device::open(config_.device, wanted_);
    if (!opened) return not_opened(opened.error());
    if (auto fits = maker_.fit(opened->image()); !fits)
      return Error{fits.error().kind, fmt::format("{}: {}", name_, fits.error().message)};
    device_.emplace(*std::move(opened));
    sequence_.restart();
    ++connections_;
    said_.clear();
    last_good_ = MonotonicClock::now();
    const v4l2::Image& image = device_->image();
    std::string what =
        fmt::format("opened '{}', {} {} x {}", device_->card(), image.format->name, image.columns, image.rows);
    if (image.rate_hz > 0.0) what += fmt::format(" at {:.4g} Hz", image.rate_hz);
    if (!device_->remark().empty()) what += "; " + device_->remark();
    return event(SourceEvent::Kind::notice, what);
  }

  /// A device that is not there is told once a loss; one that refuses, whenever its reason is another.
  Happened not_opened(const Error& error) {
    retry_.wait();
    const std::string& what = error.kind == ErrorKind::no_input ? kAbsent : error.message;
    if (said_ == what) return std::optional<SourceEvent>();
    said_ = what;
    return event(SourceEvent::Kind::notice, error.message + "; trying again until it can be used");
  }

  Happened receive(MonotonicTime now, MonotonicTime deadline) {
    const MonotonicTime silent = last_good_ + config_.deadline;
    const auto wait = std::chrono::ceil<milliseconds>(std::min(deadline, silent) - now);
    auto taken = device_->take(std::max(wait, milliseconds(0)));
    if (!taken) return lose(taken.error().message);
    if (!*taken) {  // only now: who asks late finds what has come meanwhile
      if (MonotonicClock::now() < silent) return std::optional<SourceEvent>();
      ++silences_;
      return lose(fmt::format("expected a good frame within {} ms, found none", config_.deadline.count()));
    }
    auto converted = convert(**taken);
    // one that cannot be given back is the device's end, which the next question finds out
    if (auto given = device_->give_back(**taken); !given && !converted) return lose(given.error().message);
    return converted;
  }

  std::optional<SourceEvent> convert(const v4l2::Buffer& buffer) {
    sequence_.note(buffer.sequence);
    const v4l2::Image& image = device_->image();
    if (buffer.flagged) {
      ++flagged_;
      return event(SourceEvent::Kind::skipped,
                   "buffer: expected good data, found one that the driver flags as corrupt");
    }
    if (buffer.bytes.size() < image.bytes()) {
      ++short_;
      return event(SourceEvent::Kind::skipped,
                   fmt::format("buffer: expected {} bytes, found {}", image.bytes(), buffer.bytes.size()));
    }
    auto frame = pool_.take();
    const bool stamped = maker_.fill(buffer, image, *frame);
    frame->sequence = sequence_.number();
    SourceEvent out{SourceEvent::Kind::frame, nullptr, {}};
    if (!stamped) {
      ++arrival_times_;
      if (!std::exchange(said_arrival_, true))
        out.message = fmt::format(
            "{}: time stamps: expected the monotonic clock's, found another's; frames have the "
            "time of their arrival",
            name_);
    }
    ++frames_;
    retry_.reset();
    last_good_ = frame->received;
    out.frame = std::move(frame);
    return out;
  }

  std::optional<SourceEvent> lose(const std::string& why) {
    // Linux 6.1 is not safe against a close while it still takes the device apart: it has written to freed memory
    // (v4l2_device_release in media_device_unregister_entity, found by tests/hil) and killed the thread that closed.
    std::this_thread::sleep_for(kSettles * config_.first_retry);
    device_.reset();
    ++losses_;
    said_ = kAbsent;  // this notice says it
    retry_.wait();
    return event(SourceEvent::Kind::notice, why + "; opening it again until it is there");
  }

  static inline const std::string kAbsent = "absent";

  V4l2SourceConfig config_;
  v4l2::Wanted wanted_;
  std::string name_;
  Retry retry_;
  std::optional<v4l2::Device> device_;
  v4l2::FrameMaker maker_;
  FramePool pool_;
  v4l2::SequenceCounter sequence_;
  MonotonicTime last_good_{};
  std::string said_;  ///< why the device is not open, as it was told last
  bool said_arrival_ = false;
  std::uint64_t frames_ = 0, flagged_ = 0, short_ = 0, arrival_times_ = 0;
  std::uint64_t connections_ = 0, losses_ = 0, silences_ = 0;
};

Status check(const V4l2SourceConfig& config) {
  const auto wrong = [&](const std::string& what) {
    return Error{ErrorKind::bad_config, fmt::format("v4l2 {}: {}", config.device, what)};
  };
  const ProjectionConfig& projection = config.sensor.projection;
  if (config.device.empty()) return wrong("device: expected the path of a device node, found none");
  if (projection.kind != ProjectionKind::pinhole)
    return wrong(fmt::format("projection: expected pinhole, found {}", to_string(projection.kind)));
  if (!config.format.empty() && !v4l2::range_format(config.format))
    return wrong(fmt::format("format: expected {}, or none, found '{}'", v4l2::kRangeFormatNames, config.format));
  if (config.deadline < milliseconds(1))
    return wrong(fmt::format("deadline: expected 1 ms or more, found {} ms", config.deadline.count()));
  if (!(config.rate_hz >= 0.0 && config.rate_hz <= 10'000.0))
    return wrong(fmt::format("rate_hz: expected 0 … 10000, found {}", config.rate_hz));
  if (config.rate_hz > 0.0 && std::chrono::duration<double>(1.0 / config.rate_hz) >= config.deadline)
    return wrong(fmt::format("rate_hz: expected a frame within the deadline of {} ms, found {} Hz",
                             config.deadline.count(), config.rate_hz));
  // Where the size is the device's, everything else is checked with one that contradicts nothing.
  const auto completed =
      complete_projection(projection, projection.rows > 0 ? projection.rows : std::max(projection.trusted_rows, 1),
                          std::max(projection.columns, 1));
  if (!completed) return wrong(completed.error().message);
  return {};
}

}  // namespace

Result<std::unique_ptr<Source>> open_v4l2(const V4l2SourceConfig& config) {
  if (auto checked = check(config); !checked) return checked.error();
  const ProjectionConfig& projection = config.sensor.projection;
  const v4l2::Wanted wanted{v4l2::range_format(config.format), projection.rows, projection.columns, config.rate_hz};
  return std::unique_ptr<Source>(std::make_unique<V4l2Source>(config, wanted));
}

}  // namespace scree::drivers
