#include "drivers/stream_source.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/retry.hpp"
#include "drivers/stream_events.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
constexpr std::size_t kReadBytes = std::size_t{256} << 10;
constexpr milliseconds kConnectTimeout{100};

class StreamSource final : public Source {
 public:
  StreamSource(const StreamSourceConfig& config, StreamAddress address, stream::SensorFor sensor_for)
      : deadline_(config.deadline),
        address_(std::move(address)),
        events_("stream " + to_string(address_), config.origin, std::move(sensor_for), config.poses_needed),
        chunk_(kReadBytes) {}

  Result<SourceEvent> next(milliseconds timeout) override {
    const MonotonicTime deadline = MonotonicClock::now() + timeout;
    for (;;) {
      if (auto event = decode(); !event || *event) return event ? Result(**std::move(event)) : event.error();
      const auto now = MonotonicClock::now();
      auto happened = socket_ ? receive(now, deadline) : connect(now, deadline);
      if (happened) return *std::move(happened);
      if (MonotonicClock::now() >= deadline) return SourceEvent{SourceEvent::Kind::timeout, nullptr, {}};
    }
  }

  Origin origin() const override { return events_.origin(); }
  std::string name() const override { return events_.name(); }

  SourceCounters counters() const override {
    SourceCounters out;
    events_.add_counters(out);
    out.add("connections", connections_);
    out.add("silences", silences_);
    return out;
  }

 private:
  Result<std::optional<SourceEvent>> decode() {
    const std::uint64_t before = events_.frames_heard();
    auto event = events_.next();
    if (events_.frames_heard() > before) last_good_ = MonotonicClock::now();
    if (event && *event && (*event)->kind == SourceEvent::Kind::frame) retry_.reset();
    return event;
  }

  std::optional<SourceEvent> connect(MonotonicTime now, MonotonicTime deadline) {
    if (now < retry_.at()) {
      std::this_thread::sleep_until(std::min(retry_.at(), deadline));
      return std::nullopt;
    }
    auto connected = StreamSocket::connect_to(address_, std::min(kConnectTimeout, deadline_));
    if (connected) {
      socket_ = *std::move(connected);
      ++connections_;
      said_ = false;
      last_good_ = MonotonicClock::now();
      return events_.notice("connected");
    }
    retry_.wait();
    if (std::exchange(said_, true)) return std::nullopt;  // once a loss is enough
    return events_.notice(connected.error().message + "; trying again until it is there");
  }

  std::optional<SourceEvent> receive(MonotonicTime now, MonotonicTime deadline) {
    const MonotonicTime silent = last_good_ + deadline_;
    if (now >= silent) {
      ++silences_;
      return disconnect(fmt::format("expected a frame within {} ms, found none", deadline_.count()));
    }
    const auto wait = std::chrono::ceil<milliseconds>(std::min(deadline, silent) - now);
    const auto moved = socket_->read(chunk_, std::max(wait, milliseconds(0)));
    events_.hear(std::span(chunk_).first(moved.bytes));
    if (moved.closed) return disconnect("the other end has closed the connection");
    return std::nullopt;
  }

  SourceEvent disconnect(const std::string& why) {
    socket_.reset();
    events_.disconnect();
    retry_.wait();
    return events_.notice(why + "; connecting again");
  }

  milliseconds deadline_;
  StreamAddress address_;
  StreamEvents events_;
  std::vector<std::uint8_t> chunk_;
  std::optional<StreamSocket> socket_;
  Retry retry_;
  MonotonicTime last_good_{};
  bool said_ = false;  ///< that the device is not there
  std::uint64_t connections_ = 0;
  std::uint64_t silences_ = 0;
};

}  // namespace

Result<std::unique_ptr<Source>> open_stream(const StreamSourceConfig& config, stream::SensorFor sensor_for) {
  auto address = parse_stream_address(config.address, "source.address");
  if (!address) return address.error();
  return std::unique_ptr<Source>(std::make_unique<StreamSource>(config, *std::move(address), std::move(sensor_for)));
}

}  // namespace scree::drivers
