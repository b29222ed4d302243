#pragma once
// A scanner on the testbed's USB and a source that looks for it.

#include <functional>
#include <gmock/gmock.h>
#include <memory>

#include "drivers/usb_source.hpp"
#include "tests/devices/usb_scanner.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::drivers {

class UsbTest : public ::testing::Test {
 protected:
  using Kind = SourceEvent::Kind;

  void open_source(const UsbSourceConfig& config = {}, stream::SensorFor sensor_for = stream::as_told) {
    auto opened = open_usb(config, std::move(sensor_for));
    ASSERT_TRUE(opened) << opened.error().message;
    source_ = *std::move(opened);
  }
  /// The next event that is no timeout; an event of Kind::timeout after 10 s.
  SourceEvent event() {
    for (const auto limit = MonotonicClock::now() + std::chrono::seconds(10); MonotonicClock::now() < limit;) {
      auto next = source_->next(std::chrono::milliseconds(10));
      EXPECT_TRUE(next) << next.error().message;
      if (!next || next->kind != Kind::timeout) return next ? *next : SourceEvent{};
    }
    return {};
  }
  void expect_notice(const std::string& part) {
    const auto told = event();
    EXPECT_EQ(told.kind, Kind::notice);
    EXPECT_THAT(told.message, ::testing::HasSubstr(part));
  }
  void expect_frame(std::uint64_t sequence) {
    const auto next = event();
    ASSERT_EQ(next.kind, Kind::frame) << next.message;
    EXPECT_EQ(next.frame->sequence, sequence);
  }
  std::uint64_t counted(const std::string& name) const {
    const auto counters = source_->counters();
    for (const auto& item : counters.items())
      if (item.name == name) return item.value;
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }
  static stream::Bytes message(std::uint64_t sequence) {
    return stream::encoded(stream::test_encoder(), stream::test_frame(sequence));
  }
  void connect() {
    scanner_.plug();
    expect_notice("connected");
  }

  test::Testbed bed_;
  test::UsbScanner scanner_{bed_};
  std::unique_ptr<Source> source_;
};

}  // namespace scree::drivers
