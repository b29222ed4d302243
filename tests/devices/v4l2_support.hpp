#pragma once
// What the tests of the V4L2 source share.

#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "drivers/v4l2_image.hpp"
#include "drivers/v4l2_source.hpp"
#include "tests/devices/v4l2_camera.hpp"

namespace scree::drivers {

using Kind = SourceEvent::Kind;
using std::chrono::milliseconds;

inline V4l2SourceConfig test_config() {
  V4l2SourceConfig config;
  ProjectionConfig& projection = config.sensor.projection;
  projection.kind = ProjectionKind::pinhole;
  projection.fx_px = 7.0;
  projection.fy_px = 6.5;
  projection.cx_px = 3.6;
  projection.cy_px = 2.4;
  projection.depth_unit_m = 0.001;
  config.first_retry = milliseconds(1);
  return config;
}

inline std::unique_ptr<Source> opened(const V4l2SourceConfig& config) {
  auto source = open_v4l2(config);
  if (!source) ADD_FAILURE() << source.error().message;
  return source ? *std::move(source) : nullptr;
}

/// The next event that is no timeout; one that says so after 10 s.
inline SourceEvent next_event(Source& source) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  for (;;) {
    auto event = source.next(milliseconds(20));
    if (!event) {
      ADD_FAILURE() << event.error().message;
      return {};
    }
    if (event->kind != Kind::timeout || std::chrono::steady_clock::now() > deadline) return *std::move(event);
  }
}

inline SourceEvent next_of(Source& source, Kind kind) {
  auto event = next_event(source);
  EXPECT_EQ(event.kind, kind) << event.message;
  return event;
}

inline std::uint64_t counter(const Source& source, const std::string& name) {
  const SourceCounters counters = source.counters();
  for (const auto& item : counters.items())
    if (name == item.name) return item.value;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

/// Words that differ from pixel to pixel; the first is 0, "no depth".
inline test::Picture picture(std::uint32_t sequence, std::size_t pixels = 48, std::uint16_t first = 0) {
  test::Picture out;
  out.sequence = sequence;
  for (std::size_t i = 0; i < pixels; ++i) out.words.push_back(static_cast<std::uint16_t>(first + 137 * i));
  return out;
}

}  // namespace scree::drivers
