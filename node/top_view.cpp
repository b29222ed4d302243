#include "node/top_view.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace scree::node {
namespace {

using client::Client;

constexpr std::array<const char*, 4> kStates = {"WAITING", "FRESH", "STALE", "LOST"};
constexpr std::array<const char*, 4> kOrigins = {"LIVE", "REPLAY", "SIM", "HIL"};
constexpr std::array<const char*, 4> kSensorStates = {"no frame yet", "ok", "stale", "lost"};

double ms(client::Duration duration) {
  return 1e-6 * static_cast<double>(duration.count());
}

std::string clock_text(std::uint64_t milliseconds) {
  const std::uint64_t s = milliseconds / 1000;
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string age_text(client::Duration age) {
  if (age == client::Duration::max()) return "none yet";
  return age < std::chrono::seconds(10) ? fmt::format("{:.0f} ms", ms(age)) : fmt::format("{:.1f} s", 1e-3 * ms(age));
}

std::string heartbeat_lines(const client::Heartbeat& beat, double frames_hz, double dropped_hz) {
  std::string out = fmt::format("frames   in {} ({:.1f}/s)   dropped {} ({:.1f}/s)\n", beat.frames_in, frames_hz,
                                beat.frames_dropped, dropped_hz);
  out += fmt::format("latency  p50 {:.1f} ms   p99 {:.1f} ms   max {:.1f} ms, frame in to last tile out\n",
                     1e-3 * beat.latency_p50_us, 1e-3 * beat.latency_p99_us, 1e-3 * beat.latency_max_us);
  for (std::size_t i = 0; i < beat.sensors && i < std::size(beat.sensor); ++i) {
    const client::Sensor& sensor = beat.sensor[i];
    out += fmt::format("sensor   {}: {}, last frame {} ms ago\n", sensor.sensor,
                       sensor.state < kSensorStates.size() ? kSensorStates[sensor.state] : "unknown", sensor.age_ms);
  }
  return out + fmt::format("process  up {}   {:.1f} MB\n", clock_text(beat.uptime_ms),
                           1e-6 * static_cast<double>(beat.rss_bytes));
}

std::string cost_line(const Client& map, client::Time now) {
  const client::Grid grid = map.grid();
  std::vector<std::uint8_t> cost(grid.cells());
  if (!map.copy_cost(cost.data(), cost.size(), now) || cost.empty()) return "cells    none known\n";
  std::size_t unknown = 0, lethal = 0, low = 0;
  for (const std::uint8_t c : cost) {
    unknown += c == 255 ? 1U : 0U;
    lethal += c == 254 ? 1U : 0U;
    low += c < 64 ? 1U : 0U;
  }
  const auto share = [&](std::size_t n) { return 100.0 * static_cast<double>(n) / static_cast<double>(cost.size()); };
  return fmt::format("cells    {:.1f} % below 64   {:.1f} % lethal   {:.1f} % unknown\n", share(low), share(lethal),
                     share(unknown));
}

std::string reject_line(const client::Counters& counters) {
  std::string out;
  for (std::size_t i = 1; i < counters.by_verdict.size(); ++i)
    if (counters.by_verdict[i] > 0)
      out += fmt::format("   {} {}", client::name(static_cast<client::Verdict>(i)), counters.by_verdict[i]);
  return out.empty() ? "refused  none\n" : "refused" + out.substr(1) + "\n";
}

std::string pose_line(const Client& map, client::Time now) {
  client::Pose pose;
  if (!map.pose(pose, now)) return "pose     none yet\n";
  const double yaw_rad =
      std::atan2(2.0 * (pose.qw * pose.qz + pose.qx * pose.qy), 1.0 - 2.0 * (pose.qy * pose.qy + pose.qz * pose.qz));
  return fmt::format("pose     x {:.2f} m   y {:.2f} m   z {:.2f} m   heading {:.0f} deg   {} old\n", pose.x_m,
                     pose.y_m, pose.z_m, yaw_rad * 180.0 / std::numbers::pi, age_text(pose.age));
}

}  // namespace

std::string health_text(std::uint16_t health) {
  constexpr std::array<std::pair<std::uint16_t, const char*>, 9> kBits{
      {{client::kSensorStale, "sensor stale"},
       {client::kSensorLost, "sensor lost"},
       {client::kPoseStale, "pose stale"},
       {client::kOverload, "overload"},
       {client::kCalibrationMissing, "calibration missing"},
       {client::kClockStepped, "clock stepped"},
       {client::kReducedResolution, "reduced resolution"},
       {client::kRecordingFailed, "recording failed"},
       {client::kFault, "FAULT: do not drive"}}};
  std::string out;
  for (const auto& [bit, name] : kBits)
    if ((health & bit) != 0) out += (out.empty() ? "" : ", ") + std::string(name);
  return out.empty() ? "ok" : out;
}

void TopView::take_rates(const Client& map, client::Time now) {
  Totals totals;
  if (const client::Heartbeat* beat = map.heartbeat()) {
    totals.frames = beat->frames_in;
    totals.dropped = beat->frames_dropped;
  }
  totals.datagrams = map.counters().datagrams;
  totals.tiles = map.counters().tiles;
  totals.lost = map.counters().lost;
  totals.map_rev = map.map_rev();
  const double elapsed_s = 1e-3 * ms(now - last_);
  const bool same = begun_ && boot_id_ == map.boot_id() && elapsed_s > 0.0;  // a node that began anew counts from 0
  const auto rate = [&](std::uint64_t is, std::uint64_t was) {
    return same && is >= was ? static_cast<std::uint64_t>(1e3 * static_cast<double>(is - was) / elapsed_s) : 0;
  };
  by_second_milli_ = {
      rate(totals.frames, before_.frames),       rate(totals.dropped, before_.dropped),
      rate(totals.datagrams, before_.datagrams), rate(totals.tiles, before_.tiles),
      rate(totals.lost, before_.lost),           static_cast<std::uint32_t>(rate(totals.map_rev, before_.map_rev))};
  before_ = totals;
  last_ = now;
  boot_id_ = map.boot_id();
  begun_ = true;
}

std::string TopView::text(const Client& map, client::Time now) {
  take_rates(map, now);
  const auto hz = [](std::uint64_t milli) { return 1e-3 * static_cast<double>(milli); };
  const client::Counters& counters = map.counters();
  const client::Announce* const announce = map.announce();
  const client::Heartbeat* const beat = map.heartbeat();
  std::string out = fmt::format("{}  {}{}\n", kStates[static_cast<std::size_t>(map.state(now))],
                                beat != nullptr ? kOrigins[static_cast<std::size_t>(map.origin())] : "nobody heard",
                                announce != nullptr ? fmt::format("  {} {}, frame {}", announce->node_name,
                                                                  announce->software_version, announce->frame_name)
                                                    : "");
  if (map.ended()) out += "the node said BYE\n";
  if (beat != nullptr) {
    out += "health   " + health_text(map.health(now)) + "\n";
    out += heartbeat_lines(*beat, hz(by_second_milli_.frames), hz(by_second_milli_.dropped));
  }
  if (const client::Grid grid = map.grid(); grid.columns > 0) {
    out += fmt::format("map      {} x {} cells of {:g} m   revision {} ({:.1f}/s)   data {} old\n", grid.columns,
                       grid.rows, grid.resolution_m, map.map_rev(), hz(by_second_milli_.map_rev),
                       age_text(map.data_age(now)));
    out += cost_line(map, now);
  }
  if (beat != nullptr) out += pose_line(map, now);
  const double all = static_cast<double>(counters.datagrams + counters.lost);
  out += fmt::format("link     {} datagrams ({:.0f}/s)   {} tiles ({:.0f}/s)\n", counters.datagrams,
                     hz(by_second_milli_.datagrams), counters.tiles, hz(by_second_milli_.tiles));
  out += fmt::format("lost     {} ({:.2f} %, {:.1f}/s)   by this machine {}\n", counters.lost,
                     all > 0.0 ? 100.0 * static_cast<double>(counters.lost) / all : 0.0, hz(by_second_milli_.lost),
                     counters.overflowed);
  out += reject_line(counters);
  if (const client::ClockOffset& clock = map.clock_offset(); clock.known)
    out += fmt::format("clock    node ahead by {:.2f} ms   round trip {:.2f} ms\n",
                       1e-6 * static_cast<double>(clock.offset_ns), 1e-6 * static_cast<double>(clock.round_trip_ns));
  return out;
}

}  // namespace scree::node
