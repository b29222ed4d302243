#include "drivers/stream_events.hpp"

#include <fmt/format.h>
#include <utility>

namespace scree::drivers {

Result<std::optional<SourceEvent>> StreamEvents::next() {
  for (;;) {
    if (told_refused_ < decoder_.counters().frame_payload_crc) {
      ++told_refused_;
      return std::optional(skipped("FRAME: expected the payload of its CRC, found another"));
    }
    if (const auto message = std::exchange(message_, std::nullopt)) {
      auto event = take(*message);
      if (!event || *event) return event;
    }
    message_ = decoder_.next(left_);
    if (!message_ && told_refused_ == decoder_.counters().frame_payload_crc) return std::optional<SourceEvent>();
  }
}

Result<std::optional<SourceEvent>> StreamEvents::take(const stream::Message& message) {
  frames_heard_ += message.header.type == stream::MessageType::frame ? 1U : 0U;
  if (!frame_) frame_ = pool_.take();
  const auto taken = reader_.take(message, *frame_);
  if (!taken) return Error{taken.error().kind, fmt::format("{}: {}", name_, taken.error().message)};
  switch (*taken) {
    case stream::Taken::geometry:
    case stream::Taken::ignored_type:
    case stream::Taken::bad_geometry:  // its frames say why they are of no use
      return std::optional<SourceEvent>();
    case stream::Taken::frame:
      break;
    default:
      return std::optional(skipped(reader_.reason()));
  }
  SourceEvent event{SourceEvent::Kind::frame, nullptr, {}};
  if (message.header.simulated && origin_ == Origin::live) {
    origin_ = Origin::sim;
    event.message = fmt::format("{}: the device '{}' says that it is simulated: from now on the origin is SIM", name_,
                                reader_.device());
  }
  frame_->received = MonotonicClock::now();
  event.frame = std::exchange(frame_, nullptr);
  return std::optional(std::move(event));
}

void StreamEvents::disconnect() {
  decoder_.reset();
  left_ = {};
}

SourceEvent StreamEvents::notice(const std::string& what) const {
  return {SourceEvent::Kind::notice, nullptr, fmt::format("{}: {}", name_, what)};
}

SourceEvent StreamEvents::skipped(const std::string& why) const {
  return {SourceEvent::Kind::skipped, nullptr, fmt::format("{}: {}", name_, why)};
}

void StreamEvents::add_counters(SourceCounters& out) const {
  using stream::Taken;
  const auto& decoded = decoder_.counters();
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
}

}  // namespace scree::drivers
