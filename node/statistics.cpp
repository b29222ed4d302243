#include "node/statistics.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace scree::node {
namespace {

double to_ms(Duration duration) {
  return static_cast<double>(duration.count()) * 1e-6;
}

nlohmann::ordered_json source_json(const drivers::SourceCounters& source) {
  auto json = nlohmann::ordered_json::object();
  for (const auto& item : source.items()) json[item.name] = item.value;
  return json;
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

nlohmann::ordered_json publisher_json(const PublisherCounters& publisher) {
  return {{"snapshots", publisher.snapshots},
          {"snapshots_superseded", publisher.snapshots_superseded},
          {"snapshots_refused", publisher.snapshots_refused},
          {"blocks", publisher.blocks},
          {"blocks_refreshed", publisher.blocks_refreshed},
          {"cells_saturated", publisher.cells_saturated},
          {"send_blocked", publisher.send_blocked}};
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
  const nlohmann::ordered_json json{
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
      {"source", source_json(s.source)},
      {"latency_ms", {{"p50", to_ms(s.latency_p50)}, {"p99", to_ms(s.latency_p99)}, {"max", to_ms(s.latency_max)}}},
      {"datagrams", s.publisher.datagrams},
      {"bytes", s.publisher.bytes},
      {"send_errors", s.publisher.send_errors},
      {"lost", 0},
      {"rejected", s.rejected},
      {"elapsed_s", to_seconds(s.elapsed)},
      {"mapping_s", to_seconds(s.mapping)},
      {"frames_per_s", s.frames_per_s()},
      {"publisher", publisher_json(s.publisher)},
      {"pixels", pixel_json(s.pixels)}};
  return json.dump(2);
}

}  // namespace scree::node
