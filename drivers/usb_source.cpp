#include "drivers/usb_source.hpp"

#include <fmt/format.h>
#include <optional>
#include <utility>

#include "drivers/retry.hpp"
#include "drivers/stream_events.hpp"
#include "drivers/usb_link.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using usb::TransferEnd;

/// So many recoveries without a good message between them, and the device is closed.
constexpr int kRecoveriesInARow = 4;

struct UsbCounters {
  std::uint64_t connections = 0, departures = 0, silences = 0;
  std::uint64_t stalls = 0, overflows = 0, transfer_errors = 0;
};

class UsbSource final : public Source {
 public:
  UsbSource(const UsbSourceConfig& config, std::unique_ptr<usb::Context> context, std::string name,
            stream::SensorFor sensor_for)
      : deadline_(config.deadline),
        context_(std::move(context)),
        events_(std::move(name), config.origin, std::move(sensor_for), config.poses_needed) {}

  Result<SourceEvent> next(milliseconds timeout) override {
    const MonotonicTime deadline = MonotonicClock::now() + timeout;
    for (;;) {
      if (auto event = decode(); !event || *event) return event ? Result(**std::move(event)) : event.error();
      auto happened = link_ ? receive(deadline) : connect(deadline);
      if (happened) return *std::move(happened);
      if (MonotonicClock::now() >= deadline) return SourceEvent{SourceEvent::Kind::timeout, nullptr, {}};
    }
  }

  Origin origin() const override { return events_.origin(); }
  std::string name() const override { return events_.name(); }

  SourceCounters counters() const override {
    SourceCounters out;
    events_.add_counters(out);
    out.add("connections", counters_.connections);
    out.add("departures", counters_.departures);
    out.add("silences", counters_.silences);
    out.add("stalls", counters_.stalls);
    out.add("overflows", counters_.overflows);
    out.add("transfer_errors", counters_.transfer_errors);
    return out;
  }

 private:
  Result<std::optional<SourceEvent>> decode() {
    const std::uint64_t before = events_.frames_heard();
    auto event = events_.next();
    if (events_.frames_heard() > before) {
      last_good_ = MonotonicClock::now();
      recoveries_ = 0;
      restarted_ = false;
    }
    if (event && *event && (*event)->kind == SourceEvent::Kind::frame) retry_.reset();
    return event;
  }

  std::optional<SourceEvent> connect(MonotonicTime deadline) {
    const auto now = MonotonicClock::now();
    if (context_->arrived()) retry_.hurry();
    if (now < retry_.at()) {
      context_->handle_events(std::chrono::ceil<milliseconds>(std::min(retry_.at(), deadline) - now));
      return std::nullopt;
    }
    auto why = open();
    if (!why) {
      ++counters_.connections;
      said_.clear();
      last_good_ = MonotonicClock::now();
      recoveries_ = 0;
      restarted_ = false;
      return events_.notice("connected");
    }
    retry_.wait();
    if (said_ == *why) return std::nullopt;  // once a cause is enough
    said_ = *std::move(why);
    return events_.notice(said_ + "; trying again until it is there");
  }

  /// Why not; nothing = the device is open. Reads the bus anew: what libusb knew may be old.
  std::optional<std::string> open() {
    if (auto status = context_->scan_again(); !status) return status.error().message;
    const auto device = context_->find();
    if (!device) return "expected a device, found none";
    auto link = usb::Link::open(*context_, device);
    if (!link) return link.error().message;
    link_ = *std::move(link);
    return std::nullopt;
  }

  std::optional<SourceEvent> receive(MonotonicTime deadline) {
    if (const auto taken = std::exchange(taken_, std::nullopt)) return finish(*taken);
    if (const auto completion = link_->transfers().front()) {
      events_.hear(completion->bytes);
      taken_ = completion->status;
      return std::nullopt;
    }
    if (context_->left()) return departed();
    const auto now = MonotonicClock::now();
    MonotonicTime limit = last_good_ + deadline_;
    if (recovering_) {
      if (link_->transfers().in_flight() == 0) return recovered();
      limit = recover_by_;
      if (now >= limit) return disconnect(*recovering_ + "; a cancelled transfer did not come back");
    } else if (now >= limit) {
      return silence();
    }
    context_->handle_events(std::chrono::ceil<milliseconds>(std::min(deadline, limit) - now));
    return std::nullopt;
  }

  /// With the oldest transfer, whose bytes have all been decoded.
  std::optional<SourceEvent> finish(TransferEnd status) {
    if (status == TransferEnd::no_device) return departed();
    const bool asked_for = recovering_ && status == TransferEnd::cancelled;
    const bool good = status == TransferEnd::completed || asked_for;
    if (status == TransferEnd::stalled)
      ++counters_.stalls;
    else if (status == TransferEnd::overflow)
      ++counters_.overflows;
    else if (!good)
      ++counters_.transfer_errors;
    if (!good && status != TransferEnd::timed_out && !recovering_) {
      if (auto gave_up = recover(fmt::format("a transfer came back: {}", usb::to_string(status)))) return gave_up;
    }
    if (recovering_) {
      link_->transfers().retire();
      return std::nullopt;
    }
    const int code = link_->transfers().release();
    if (code == 0) return std::nullopt;
    ++counters_.transfer_errors;
    return recover(fmt::format("submitting a transfer: {}", usb::error_name(code)));
  }

  /// Asks for all transfers back; their bytes are used as they come. Nothing is told of a recovery that works: it is
  /// counted. Unplugging often begins like this.
  std::optional<SourceEvent> recover(std::string why) {
    if (context_->left()) return departed();
    if (++recoveries_ > kRecoveriesInARow)
      return disconnect(fmt::format("{}, {} times without a good message", why, recoveries_));
    link_->transfers().cancel();
    recovering_ = std::move(why);
    recover_by_ = MonotonicClock::now() + usb::kDrainTimeout;
    return std::nullopt;
  }

  /// All transfers are back and their bytes used.
  std::optional<SourceEvent> recovered() {
    const auto why = *std::exchange(recovering_, std::nullopt);
    const auto status = link_->resume();
    if (status) return std::nullopt;
    if (context_->left() || link_->gone()) return departed();
    return disconnect(fmt::format("{}; {}", why, status.error().message));
  }

  std::optional<SourceEvent> silence() {
    ++counters_.silences;
    const auto why = fmt::format("expected a frame within {} ms, found none", deadline_.count());
    last_good_ = MonotonicClock::now();
    if (!std::exchange(restarted_, true)) {
      if (const auto status = link_->restart_stream(); !status)
        return link_->gone() ? departed() : disconnect(fmt::format("{}; {}", why, status.error().message));
      return events_.notice(why + "; stream restarted");
    }
    link_->reset();
    return disconnect(why + " after the stream was restarted; device reset");
  }

  SourceEvent departed() {
    ++counters_.departures;
    link_->set_gone();
    return disconnect("the device has gone");
  }

  SourceEvent disconnect(const std::string& why) {
    link_.reset();
    events_.disconnect();
    taken_.reset();
    recovering_.reset();
    retry_.wait();
    return events_.notice(why + "; connecting again");
  }

  milliseconds deadline_;
  std::unique_ptr<usb::Context> context_;
  StreamEvents events_;
  std::unique_ptr<usb::Link> link_;   ///< null = not connected
  std::optional<TransferEnd> taken_;  ///< of the oldest transfer, whose bytes are being decoded
  Retry retry_;
  MonotonicTime last_good_{};
  std::optional<std::string> recovering_;  ///< why; all transfers have been asked back
  MonotonicTime recover_by_{};
  int recoveries_ = 0;      ///< since the last good message
  bool restarted_ = false;  ///< since the last good message
  std::string said_;        ///< why the device is not there, as last told
  UsbCounters counters_;
};

}  // namespace

Result<std::unique_ptr<Source>> open_usb(const UsbSourceConfig& config, stream::SensorFor sensor_for) {
  const usb::Identity identity{config.vendor_id, config.product_id, config.serial};
  auto context = usb::Context::make(identity);
  if (!context) return context.error();
  return std::unique_ptr<Source>(std::make_unique<UsbSource>(config, *std::move(context),
                                                             "usb " + usb::to_string(identity), std::move(sensor_for)));
}

}  // namespace scree::drivers
