#include "node/statistics.hpp"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace scree::node {
namespace {

double to_ms(Duration duration) {
  return static_cast<double>(duration.count()) * 1e-6;
}

nlohmann::ordered_json pixel_json(const PixelCounts& pixels) {
  return {{"pixels", pixels.pixels},
          {"points", pixels.points},
          {"no_return", pixels.no_return},
          {"untrusted_row", pixels.untrusted_row},
          {"out_of_limits", pixels.out_of_limits},
          {"self", pixels.self},
          {"speckle", pixels.speckle},
          {"mixed", pixels.mixed},
          {"ambiguous", pixels.ambiguous},
          {"assumed_first_interval", pixels.assumed_first_interval},
          {"wrapped", pixels.wrapped}};
}

nlohmann::ordered_json publisher_json(const PublisherCounters& publisher, std::uint64_t superseded) {
  return {{"snapshots", publisher.snapshots},
          {"snapshots_superseded", publisher.snapshots_superseded},
          {"snapshots_refused", publisher.snapshots_refused},
          {"blocks", publisher.blocks},
          {"blocks_refreshed", publisher.blocks_refreshed},
          {"blocks_repeated", publisher.blocks_repeated},
          {"cells_saturated", publisher.cells_saturated},
          {"poses", publisher.poses},
          {"poses_superseded", publisher.poses_superseded + superseded},
          {"send_blocked", publisher.send_blocked}};
}

nlohmann::ordered_json counters_json(const drivers::SourceCounters& counters) {
  auto json = nlohmann::ordered_json::object();
  for (const auto& item : counters.items()) json[item.name] = item.value;
  return json;
}

nlohmann::ordered_json sources_json(const std::vector<SourceStatistics>& sources) {
  auto json = nlohmann::ordered_json::array();
  for (const SourceStatistics& s : sources)
    json.push_back({{"name", s.name},
                    {"frames_in", s.frames_in},
                    {"frames_skipped", s.frames_skipped},
                    {"frames_dropped", s.frames_dropped},
                    {"frames_late", s.frames_late},
                    {"frames_mapped", s.frames_mapped},
                    {"failures", s.failures},
                    {"abandoned", s.abandoned},
                    {"counters", counters_json(s.counters)}});
  return json;
}

/// The reasons that occurred.
nlohmann::ordered_json reasons_json(const std::array<std::uint64_t, protocol::kRejectReasons>& rejected_by) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < rejected_by.size(); ++i)
    if (rejected_by[i] > 0) json[std::string(protocol::reject_name(static_cast<protocol::Reject>(i)))] = rejected_by[i];
  return json;
}

nlohmann::ordered_json clients_json(const Statistics& s) {
  const SubscriptionCounters& c = s.subscriptions;
  return {{"subscribers", s.subscribers},
          {"subscribes", c.subscribes},
          {"cookies", c.cookies},
          {"cookie_unknown", c.cookie_unknown},
          {"begun", c.begun},
          {"ended", c.ended},
          {"lease_expired", c.lease_expired},
          {"refused_full", c.refused_full},
          {"outdated", c.outdated},
          {"nacks", c.nacks},
          {"nacks_unsubscribed", c.nacks_unsubscribed},
          {"nack_tiles", c.nack_tiles},
          {"tiles_requeued", c.tiles_requeued},
          {"pings", c.pings},
          {"rate_limited", c.rate_limited}};
}

nlohmann::ordered_json received_json(const Statistics& s) {
  const PoseInputCounters& poses = s.inbox.poses;
  return {{"requests", s.inbox.requests.datagrams},
          {"requests_rejected", reasons_json(s.inbox.requests.rejected_by)},
          {"requests_overflowed", s.requests_overflowed},
          {"poses", poses.datagrams},
          {"poses_accepted", poses.accepted},
          {"poses_rejected", reasons_json(poses.rejected_by)},
          {"poses_foreign_address", poses.foreign_address},
          {"poses_not_later", poses.not_later},
          {"poses_in_future", poses.in_future},
          {"poses_in_past", poses.in_past},
          {"overflowed", s.inbox.overflowed}};
}

}  // namespace

std::string to_line(const Statistics& s) {
  return fmt::format(
      "frames {} mapped {} dropped {} skipped {} pose-stale {} · map p50 {:.1f} p99 {:.1f} ms · "
      "cells {} · datagrams {}",
      s.frames_in, s.frames_mapped, s.frames_dropped, s.frames_skipped, s.frames_pose_stale, to_ms(s.latency_p50),
      to_ms(s.latency_p99), s.cells_measured, s.publisher.datagrams);
}

std::string to_json(const Statistics& s) {
  nlohmann::ordered_json json{
      {"frames_in", s.frames_in},
      {"frames_dropped", s.frames_dropped},
      {"frames_skipped", s.frames_skipped},
      {"frames_pose_stale", s.frames_pose_stale},
      {"frames_mapped", s.frames_mapped},
      {"points", s.pixels.points},
      {"points_fused", s.points_fused},
      {"points_outside", s.points_outside},
      {"points_outlier", s.points_outlier},
      {"points_other_surface", s.points_other_surface},
      {"points_unsupported", s.points_unsupported},
      {"pose_jumps", s.pose_jumps},
      {"frames_refused", s.frames_refused},
      {"maps_forgotten", s.maps_forgotten},
      {"registration_m", s.registration_m},
      {"cells_measured", s.cells_measured},
      {"latency_ms", {{"p50", to_ms(s.latency_p50)}, {"p99", to_ms(s.latency_p99)}, {"max", to_ms(s.latency_max)}}},
      {"latency_out_ms",
       {{"p50", to_ms(s.latency_out_p50)}, {"p99", to_ms(s.latency_out_p99)}, {"max", to_ms(s.latency_out_max)}}},
      {"datagrams", s.publisher.datagrams},
      {"bytes", s.publisher.bytes},
      {"send_errors", s.publisher.send_errors},
      {"lost", 0},
      {"rejected", s.inbox.rejected()},
      {"elapsed_s", to_seconds(s.elapsed)},
      {"mapping_s", to_seconds(s.mapping)},
      {"frames_per_s", s.frames_per_s()},
      {"source", counters_json(s.sources.size() == 1 ? s.sources[0].counters : drivers::SourceCounters())},
      {"sources", sources_json(s.sources)},
      {"publisher", publisher_json(s.publisher, s.poses_superseded)},
      {"clients", clients_json(s)},
      {"received", received_json(s)},
      {"health_changes", s.health_changes},
      {"pixels", pixel_json(s.pixels)}};
  if (s.recorder)
    json["recording"] = {{"frames", s.recorder->frames},
                         {"dropped", s.recorder->dropped},
                         {"refused", s.recorder->refused},
                         {"restamped", s.recorder->restamped},
                         {"failed", s.recorder->failed}};
  return json.dump(2);
}

}  // namespace scree::node
