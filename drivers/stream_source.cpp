#include "drivers/stream_source.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/frame_pool.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
constexpr std::size_t kReadBytes = std::size_t{256} << 10;
constexpr milliseconds kConnectTimeout{100};

class StreamSource final : public Source {
 public:
  StreamSource(StreamSourceConfig config, StreamAddress address, stream::SensorFor sensor_for)
      : config_(std::move(config)),
        address_(std::move(address)),
        name_("stream " + to_string(address_)),
        origin_(config_.origin),
        reader_(std::move(sensor_for), config_.poses_needed),
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

  Origin origin() const override { return origin_; }
  std::string name() const override { return name_; }

  SourceCounters counters() const override {
    using stream::Taken;
    const auto& decoded = decoder_.counters();
    SourceCounters out;
    out.add("bytes", decoded.bytes);
    out.add("bytes_skipped", decoded.bytes_skipped);
    out.add("messages", decoded.messages);
    out.add("header_crc", decoded.header_crc);
    out.add("version", decoded.version);
    out.add("oversize", decoded.oversize);
    out.add("payload_crc", decoded.payload_crc);
    out.add("ignored_type", reader_.taken(Taken::ignored_type));
    out.add("bad_geometry", reader_.taken(Taken::bad_geometry));
    out.add("no_geometry", reader_.taken(Taken::no_geometry));
    out.add("bad_frame", reader_.taken(Taken::bad_frame));
    out.add("no_pose", reader_.taken(Taken::no_pose));
    out.add("frames_missing", reader_.missing());
    out.add("connections", connections_);
    out.add("silences", silences_);
    return out;
  }

 private:
  SourceEvent notice(const std::string& what) const {
    return {SourceEvent::Kind::notice, nullptr, fmt::format("{}: {}", name_, what)};
  }

  /// The next event in the bytes at hand, if there is one. A frame that was refused is told before what followed it.
  Result<std::optional<SourceEvent>> decode() {
    for (;;) {
      if (told_refused_ < decoder_.counters().frame_payload_crc) {
        ++told_refused_;
        return skipped("FRAME: expected the payload of its CRC, found another");
      }
      if (const auto message = std::exchange(message_, std::nullopt)) {
        auto event = take(*message);
        if (!event || *event) return event;
      }
      message_ = decoder_.next(left_);
      if (!message_ && told_refused_ == decoder_.counters().frame_payload_crc) return std::optional<SourceEvent>();
    }
  }

  Result<std::optional<SourceEvent>> take(const stream::Message& message) {
    if (!frame_) frame_ = pool_.take();
    const auto taken = reader_.take(message, *frame_);
    if (!taken) return Error{taken.error().kind, fmt::format("{}: {}", name_, taken.error().message)};
    last_good_ = MonotonicClock::now();
    switch (*taken) {
      case stream::Taken::geometry:
      case stream::Taken::ignored_type:
      case stream::Taken::bad_geometry:  // its frames say why they are of no use
        return std::optional<SourceEvent>();
      case stream::Taken::frame:
        break;
      default:
        return skipped(reader_.reason());
    }
    SourceEvent event{SourceEvent::Kind::frame, nullptr, {}};
    if (message.header.simulated && origin_ == Origin::live) {
      origin_ = Origin::sim;
      event.message = fmt::format("{}: the device '{}' says that it is simulated: from now on the origin is SIM", name_,
                                  reader_.device());
    }
    retry_ = kFirstRetry;
    frame_->received = last_good_;
    event.frame = std::exchange(frame_, nullptr);
    return std::optional(std::move(event));
  }

  std::optional<SourceEvent> skipped(const std::string& why) const {
    return SourceEvent{SourceEvent::Kind::skipped, nullptr, fmt::format("{}: {}", name_, why)};
  }

  std::optional<SourceEvent> connect(MonotonicTime now, MonotonicTime deadline) {
    if (now < retry_at_) {
      std::this_thread::sleep_until(std::min(retry_at_, deadline));
      return std::nullopt;
    }
    auto connected = StreamSocket::connect_to(address_, std::min(kConnectTimeout, milliseconds(config_.deadline)));
    if (connected) {
      socket_ = *std::move(connected);
      ++connections_;
      said_ = false;
      last_good_ = MonotonicClock::now();
      return notice("connected");
    }
    wait_before_retry();
    if (std::exchange(said_, true)) return std::nullopt;  // once a loss is enough
    return notice(connected.error().message + "; trying again until it is there");
  }

  std::optional<SourceEvent> receive(MonotonicTime now, MonotonicTime deadline) {
    const MonotonicTime silent = last_good_ + config_.deadline;
    if (now >= silent) {
      ++silences_;
      return disconnect(fmt::format("expected a message within {} ms, found none", config_.deadline.count()));
    }
    const auto wait = std::chrono::ceil<milliseconds>(std::min(deadline, silent) - now);
    const auto moved = socket_->read(chunk_, std::max(wait, milliseconds(0)));
    left_ = std::span(chunk_).first(moved.bytes);
    if (moved.closed) return disconnect("the other end has closed the connection");
    return std::nullopt;
  }

  SourceEvent disconnect(const std::string& why) {
    socket_.reset();
    decoder_.reset();
    left_ = {};
    wait_before_retry();
    return notice(why + "; connecting again");
  }

  void wait_before_retry() {
    retry_at_ = MonotonicClock::now() + retry_;
    retry_ = std::min(2 * retry_, kLastRetry);
  }

  StreamSourceConfig config_;
  StreamAddress address_;
  std::string name_;
  Origin origin_;
  stream::Decoder decoder_;
  stream::FrameReader reader_;
  FramePool pool_;
  std::shared_ptr<RangeFrame> frame_;  ///< to be filled next
  std::vector<std::uint8_t> chunk_;
  std::span<const std::uint8_t> left_;      ///< of the chunk
  std::optional<stream::Message> message_;  ///< decoded and not taken yet
  std::uint64_t told_refused_ = 0;
  std::optional<StreamSocket> socket_;
  milliseconds retry_ = kFirstRetry;
  MonotonicTime retry_at_{};
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
