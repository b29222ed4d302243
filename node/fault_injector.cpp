#include "node/fault_injector.hpp"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "drivers/frame_damage.hpp"

namespace scree::node {

using drivers::Fault;
using drivers::FaultKind;

std::vector<Fault> FaultInjector::advance(Duration since, drivers::FrameServer& server) {
  now_ = since;
  std::vector<Fault> begun;
  for (; next_ < faults_.size() && faults_[next_].at <= since; ++next_) {
    begin(faults_[next_], server);
    begun.push_back(faults_[next_]);
  }
  drivers::LinkState link;
  link.unplugged = since < unplugged_until_;
  link.frozen = since < frozen_until_;
  if (since < slow_until_) link.frame_time = from_seconds(factor_ * to_seconds(frame_period_));
  server.set_link(link);
  return begun;
}

void FaultInjector::begin(const Fault& fault, drivers::FrameServer& server) {
  ++injected_[static_cast<std::size_t>(fault.kind)];
  const Duration until = fault.at + fault.lasts;
  // One that lasts longer goes on when a shorter one of its kind is over; a new factor of slow takes the old one's
  // place.
  switch (fault.kind) {
    case FaultKind::unplug:
      unplugged_until_ = std::max(unplugged_until_, until);
      break;
    case FaultKind::stall:
      server.stall();
      break;
    case FaultKind::babble:
      server.babble();
      break;
    case FaultKind::corrupt:
      to_corrupt_ += fault.frames;
      break;
    case FaultKind::slow:
      slow_until_ = until;
      factor_ = fault.factor;
      break;
    case FaultKind::wrong_geometry:
      wrong_until_ = std::max(wrong_until_, until);
      break;
    case FaultKind::freeze:
      frozen_until_ = std::max(frozen_until_, until);
      break;
  }
}

drivers::ServedFrame FaultInjector::spoil(drivers::ServedFrame frame, std::uint64_t sequence) {
  using Bytes = std::vector<std::uint8_t>;
  if (now_ < wrong_until_) {
    ++frames_of_wrong_geometry_;
    frame.message = std::make_shared<const Bytes>(drivers::with_other_geometry(*frame.message, other_geometry_));
    if (frame.image != nullptr) {
      const auto half = std::span(*frame.image).first(frame.image->size() / 4 * 2);  // whole pixels
      frame.image = std::make_shared<const Bytes>(half.begin(), half.end());
    }
  }
  if (to_corrupt_ > 0) {
    --to_corrupt_;
    ++frames_corrupted_;
    const auto flipped = [sequence](const Bytes& bytes) {
      Bytes copy = bytes;
      drivers::flip_bytes(copy, sequence);
      return std::make_shared<const Bytes>(std::move(copy));
    };
    frame.message = flipped(*frame.message);
    if (frame.image != nullptr) frame.image = flipped(*frame.image);
    frame.image_damaged = true;
  }
  return frame;
}

}  // namespace scree::node
