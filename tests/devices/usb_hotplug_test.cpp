// Scanners that come, go, belong to others or are none.

#include <chrono>
#include <gtest/gtest.h>
#include <sys/fsuid.h>
#include <unistd.h>

#include "drivers/usb_devices.hpp"
#include "tests/devices/usb_fixture.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

TEST_F(UsbTest, ADeviceThatArrivesIsOpenedAtOnceAndNotOnlyWhenARetryIsDue) {
  open_source();
  expect_notice("expected a device, found none; trying again");
  // until retries are 2 s apart: 0.1 + 0.2 + 0.4 + 0.8 + 1.6 s, and not at an end of one
  const auto begin = MonotonicClock::now();
  while (MonotonicClock::now() < begin + milliseconds(3300))
    EXPECT_EQ(source_->next(milliseconds(50))->kind, Kind::timeout) << "told once";
  scanner_.plug();
  const auto plugged = MonotonicClock::now();
  expect_notice("connected");
  EXPECT_LT(MonotonicClock::now() - plugged, milliseconds(1500)) << "the next retry is due 1.8 s from now";
}

TEST_F(UsbTest, ADeviceThatNobodyAnnouncesIsFoundToo) {
  open_source();
  expect_notice("expected a device, found none");
  scanner_.plug(false);
  expect_notice("connected");
  scanner_.send(message(0));
  expect_frame(0);
  scanner_.unplug(false);
  expect_notice("has gone");
  scanner_.plug(false);
  expect_notice("connected");
}

/// libusb mostly notices itself that it knows the device; the source does not look at arrivals while one is open.
TEST_F(UsbTest, ASecondArrivalOfTheSameDeviceChangesNothing) {
  open_source();
  expect_notice("found none");
  connect();
  scanner_.announce_again();
  scanner_.announce_again();
  scanner_.send(message(0));
  expect_frame(0);
  scanner_.announce_again();
  scanner_.send(message(1));
  expect_frame(1);
  EXPECT_EQ(counted("connections"), 1u);
  EXPECT_EQ(counted("departures"), 0u);
}

TEST_F(UsbTest, AFrameThatCameBeforeTheUnplugIsNotLost) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.send(message(0));
  scanner_.unplug(false);  // what tells first is a transfer that cannot be submitted again
  expect_frame(0);
  expect_notice("has gone");
  EXPECT_EQ(counted("departures"), 1u);
  EXPECT_EQ(counted("bytes_skipped"), 0u);
}

/// What the transfers in flight end with when the device goes, and whether udev tells: the order varies.
struct Symptom {
  int status;
  bool announced;
};
class UsbUnplug : public UsbTest, public ::testing::WithParamInterface<Symptom> {};

TEST_P(UsbUnplug, InMidFrameLosesThatFrameAndFramesGoOnWhenItIsBack) {
  scanner_.change([](auto& state) { state.unplug_status = GetParam().status; });
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.send(message(0));
  expect_frame(0);
  const auto half = message(1);
  scanner_.send({half.begin(), half.end() - 20});
  EXPECT_EQ(source_->next(milliseconds(20))->kind, Kind::timeout);
  scanner_.unplug(GetParam().announced);
  expect_notice("has gone; connecting again");
  scanner_.plug(GetParam().announced);
  for (auto told = event(); told.message.find(": connected") == std::string::npos; told = event())
    ASSERT_EQ(told.kind, Kind::notice) << told.message;  // it may have been looked for while it was away
  scanner_.send(message(2));
  expect_frame(2);
  EXPECT_EQ(counted("departures"), 1u);
  EXPECT_EQ(counted("connections"), 2u);
  EXPECT_EQ(counted("frames_missing"), 1u);
  EXPECT_EQ(counted("bytes_skipped"), half.size() - 20 - stream::kHeaderBytes - stream::kGeometryBytes);
}

INSTANTIATE_TEST_SUITE_P(Symptoms, UsbUnplug,
                         ::testing::Values(Symptom{-ESHUTDOWN, true}, Symptom{-ESHUTDOWN, false},
                                           Symptom{-EPROTO, true}, Symptom{-EPROTO, false}, Symptom{-ENOENT, true},
                                           Symptom{-ENOENT, false}));

TEST_F(UsbTest, OnlyTheSerialNumberThatWasConfiguredIsTaken) {
  test::UsbScanner other(bed_, "B2");
  UsbSourceConfig config;
  config.serial = "B2";
  scanner_.plug();
  open_source(config);
  expect_notice("usb 1209:0001 serial B2: expected a device, found none");
  scanner_.unplug();
  other.plug();
  expect_notice("connected");
  source_.reset();  // before its device is
}

TEST_F(UsbTest, AnInterfaceInUseIsNamedAndTakenWhenItIsFree) {
  scanner_.change([](auto& state) { state.claim_error = EBUSY; });
  scanner_.plug();
  open_source();
  expect_notice(scanner_.node() + ": expected interface 1 to be free, found it in use");
  scanner_.change([](auto& state) { state.claim_error = 0; });
  expect_notice("connected");
}

/// As somebody who may not write to root's devices, this thread alone: root may do everything.
class Nobody {
 public:
  Nobody() { setfsuid(65'534); }
  ~Nobody() { setfsuid(getuid()); }
};

TEST_F(UsbTest, AMissingPermissionNamesTheNodeAndTheRule) {
  namespace fs = std::filesystem;
  scanner_.plug();
  // umockdev ends a process that may not reach its sockets: here the node alone says no
  for (const auto& entry : fs::recursive_directory_iterator(bed_.root() + "/ioctl"))
    fs::permissions(entry, fs::perms(0777));
  for (const char* folder : {"", "/dev", "/sys", "/ioctl"}) fs::permissions(bed_.root() + folder, fs::perms(0755));
  fs::permissions(bed_.root() + scanner_.node(), fs::perms(getuid() == 0 ? 0600 : 0));
  open_source();
  {
    const Nobody nobody;
    expect_notice(scanner_.node() + ": expected permission to read and write, found none; copy launch/99-scree.rules");
    const auto listed = list_usb_scanners();
    ASSERT_TRUE(listed && listed->size() == 1);
    EXPECT_THAT(listed->front().why_not, HasSubstr("expected permission"));
  }
  fs::permissions(bed_.root() + scanner_.node(), fs::perms(0600));
  expect_notice("connected");
}

TEST_F(UsbTest, WhatIsNoScannerOfThisVersionSaysWhy) {
  const struct {
    std::function<void(test::ScannerState&)> fault;
    const char* expected;
  } cases[] = {
      {[](auto& state) { state.info[0] = 2; }, "GET_INFO: expected major version 1 of the frame stream, found 2.0"},
      {[](auto& state) { state.info.resize(5); }, "GET_INFO: expected 8 bytes, found 5"},
      {[](auto& state) { state.protocol = 9; }, "with a bulk IN endpoint, found one of protocol 9"},
      {[](auto& state) { state.endpoint_type = 3; }, "found interface 1 without a bulk IN endpoint"},
  };
  for (const auto& item : cases) {
    test::UsbScanner scanner(bed_);
    scanner.change(item.fault);
    scanner.plug();
    open_source();
    expect_notice(item.expected);
    EXPECT_EQ(scanner.state().streaming_on, 0);
  }
}

TEST_F(UsbTest, ScannersAreListedWithWhatTheyAreAndWhetherTheyAreInUse) {
  EXPECT_TRUE(list_usb_scanners()->empty());
  scanner_.plug();
  const auto listed = list_usb_scanners();
  ASSERT_TRUE(listed && listed->size() == 1);
  const UsbDeviceInfo& info = listed->front();
  EXPECT_EQ(info.node, scanner_.node());
  EXPECT_EQ(info.bus, 1);
  EXPECT_EQ(info.ports, "1-1");
  EXPECT_EQ(info.vendor_id, 0x1209);
  EXPECT_EQ(info.product_id, 0x0001);
  EXPECT_EQ(info.product, "Test scanner");
  EXPECT_EQ(info.serial, "A1");
  EXPECT_EQ(info.interface_number, 1);
  EXPECT_EQ(info.speed, "480 Mbit/s");
  EXPECT_EQ(info.why_not, "");
  open_source();
  expect_notice("connected");
  const auto used = list_usb_scanners();
  ASSERT_TRUE(used && used->size() == 1);
  EXPECT_FALSE(used->front().usable());
  EXPECT_THAT(used->front().why_not, HasSubstr("in use"));
  scanner_.send(message(0));
  expect_frame(0);
}

}  // namespace
}  // namespace scree::drivers
