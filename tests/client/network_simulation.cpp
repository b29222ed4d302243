#include "tests/client/network_simulation.hpp"

#include <algorithm>

namespace scree::test {
namespace {

constexpr Nanoseconds kStep = std::chrono::milliseconds(1);
constexpr Nanoseconds kLookEvery = std::chrono::milliseconds(500);

}  // namespace

NetworkSimulation::NetworkSimulation(const SimulationSettings& settings, ClientPort& client)
    : settings_(settings),
      client_(client),
      sender_(settings.sender),
      down_(settings.down, settings.network_seed),
      up_(settings.up, settings.network_seed + 1) {}

void NetworkSimulation::set_black_out(bool on) {
  down_.set_black_out(on);
  up_.set_black_out(on);
}

void NetworkSimulation::replace_sender(const MapSenderSettings& settings) {
  sender_ = MapSender(settings);
  awaited_.clear();
}

SimulationResult NetworkSimulation::run(const std::function<void(Nanoseconds)>& each_step) {
  for (Nanoseconds now{0}; now <= settings_.duration; now += kStep) {
    step(now);
    if (each_step) each_step(now);
  }
  return result_;
}

void NetworkSimulation::step(Nanoseconds now) {
  const auto send = [&](std::span<const std::uint8_t> datagram) { down_.send(datagram, now); };
  const std::uint32_t before = sender_.revision();
  sender_.tick(now, send);
  if (sender_.revision() != before && now >= settings_.warm_up && now + settings_.limit <= settings_.duration)
    awaited_.push_back({now + settings_.limit, sender_.changes()});
  up_.deliver(now, [&](std::span<const std::uint8_t> datagram) { sender_.receive(datagram, now, send); });
  down_.deliver(now, [&](std::span<const std::uint8_t> datagram) { client_.accept(datagram, now); });
  for (const auto& request : client_.requests(now)) up_.send(request, now);
  check_changes(now);
  if (now >= settings_.warm_up && now % kLookEvery == Nanoseconds{0}) look(now);
}

void NetworkSimulation::check_changes(Nanoseconds now) {
  if (awaited_.empty() || awaited_.front().due > now) return;
  const node::TileWindow& tiles = sender_.tiles();
  const auto held = client_.revisions(tiles.min.tx, tiles.min.ty, tiles.columns, tiles.rows);
  const auto& layers = settings_.sender.layers;
  for (; !awaited_.empty() && awaited_.front().due <= now; awaited_.pop_front()) {
    for (const Change& change : awaited_.front().changes) {
      const auto layer =
          static_cast<std::size_t>(std::find(layers.begin(), layers.end(), change.layer) - layers.begin());
      const std::size_t unit = layer * static_cast<std::size_t>(tiles.tiles()) + tiles.position(change.tile);
      ++result_.changes;
      result_.missed += held[unit] < change.rev;
    }
  }
}

void NetworkSimulation::look(Nanoseconds now) {
  const Judgement judgement = judge(client_.show(now), sender_);
  ++result_.looks;
  result_.judgement.known += judgement.known;
  result_.judgement.unknown += judgement.unknown;
  result_.judgement.wrong += judgement.wrong;
  result_.judgement.revisions_behind = std::max(result_.judgement.revisions_behind, judgement.revisions_behind);
  if (result_.judgement.first_wrong.empty()) result_.judgement.first_wrong = judgement.first_wrong;
}

}  // namespace scree::test
