// The simulated USB device without a wire: descriptors, control requests, transfers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "drivers/little_endian.hpp"
#include "drivers/simulated_usb_device.hpp"
#include "drivers/usb_protocol.hpp"

namespace scree::drivers::usb {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::ElementsAre;

const ServedShape kCamera{"simulated depth", 60, 80, true, std::chrono::milliseconds(100), 12'000};
const ServedShape kScanner{"simulated perceptron-cmu", 256, 256, false, std::chrono::milliseconds(500), 300'000};

SharedBytes bytes_of(std::size_t count, std::uint8_t first = 0) {
  auto bytes = std::make_shared<Bytes>(count);
  for (std::size_t i = 0; i < count; ++i) (*bytes)[i] = static_cast<std::uint8_t>(first + i);
  return bytes;
}

/// What a host sees of the transfers.
struct Host {
  struct Answer {
    std::uint8_t endpoint;
    std::uint64_t id;
    TransferStatus status;
    Bytes bytes;
  };
  std::vector<Answer> answers;
  AnswerSink sink = [this](const TransferAnswer& a) {
    answers.push_back({a.endpoint, a.id, a.status, Bytes(a.bytes.begin(), a.bytes.end())});
  };
  Bytes joined() const {
    Bytes all;
    for (const Answer& a : answers) all.insert(all.end(), a.bytes.begin(), a.bytes.end());
    return all;
  }
};

/// Type and bytes of each descriptor in a configuration; fails when a length leads outside.
std::vector<Bytes> parts_of(const Bytes& configuration) {
  std::vector<Bytes> parts;
  for (std::size_t at = 0; at < configuration.size();) {
    const std::size_t length = configuration[at];
    if (length < 2 || at + length > configuration.size()) {
      ADD_FAILURE() << "descriptor at byte " << at << " of length " << length;
      break;
    }
    parts.emplace_back(configuration.begin() + static_cast<std::ptrdiff_t>(at),
                       configuration.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return parts;
}

TEST(UsbDescriptors, ACompositeDeviceHasTheScannerAndTheCamera) {
  const Descriptors made = make_descriptors(kCamera);
  EXPECT_EQ(made.device.size(), 18u);
  EXPECT_EQ(read_number<std::uint16_t>(made.device.data() + 8), kVendorId);
  EXPECT_EQ(read_number<std::uint16_t>(made.device.data() + 10), kProductId);
  EXPECT_EQ(read_number<std::uint16_t>(made.configuration.data() + 2), made.configuration.size());
  std::map<std::uint8_t, Bytes> interfaces;
  std::vector<std::uint8_t> endpoints;
  for (const Bytes& part : parts_of(made.configuration)) {
    if (part[1] == 4) interfaces[part[2]] = part;
    if (part[1] == 5) {
      endpoints.push_back(part[2]);
      EXPECT_EQ(part[3], 2) << "bulk";
      EXPECT_EQ(read_number<std::uint16_t>(part.data() + 4), kBulkPacketBytes);
    }
  }
  ASSERT_EQ(interfaces.size(), 3u);
  EXPECT_EQ(made.configuration[4], 3);
  EXPECT_EQ(interfaces[kScannerInterface][5], kInterfaceClass);
  EXPECT_EQ(interfaces[kScannerInterface][6], kInterfaceSubclass);
  EXPECT_EQ(interfaces[kScannerInterface][7], kInterfaceProtocol);
  EXPECT_EQ(interfaces[kCameraControlInterface][5], 0x0E);
  EXPECT_EQ(interfaces[kCameraInterface][6], 2) << "video streaming";
  EXPECT_THAT(endpoints, ElementsAre(kFrameEndpoint, kCameraEndpoint));
}

/// The class-specific descriptors of an interface, of subtype → bytes, and the total that its header claims.
TEST(UsbDescriptors, TheCameraOffersZ16OfItsSize) {
  Bytes format, frame;
  std::map<std::uint8_t, std::size_t> total, claimed;  // by interface
  std::uint8_t interface = 0;
  for (const Bytes& part : parts_of(make_descriptors(kCamera).configuration)) {
    if (part[1] == 4) interface = part[2];
    if (part[1] != 0x24) continue;
    total[interface] += part.size();
    if (interface == kCameraControlInterface && part[2] == 1)
      claimed[interface] = read_number<std::uint16_t>(part.data() + 5);
    if (interface == kCameraInterface && part[2] == 1) claimed[interface] = read_number<std::uint16_t>(part.data() + 4);
    if (interface == kCameraInterface && part[2] == 4) format = part;
    if (interface == kCameraInterface && part[2] == 5) frame = part;
  }
  EXPECT_EQ(total, claimed);
  ASSERT_EQ(format.size(), 27u);
  EXPECT_EQ(std::string(format.begin() + 5, format.begin() + 9), "Z16 ");
  EXPECT_EQ(format[21], 16) << "bits a pixel";
  ASSERT_EQ(frame.size(), 30u);
  EXPECT_EQ(read_number<std::uint16_t>(frame.data() + 5), kCamera.columns);
  EXPECT_EQ(read_number<std::uint16_t>(frame.data() + 7), kCamera.rows);
  EXPECT_EQ(read_number<std::uint32_t>(frame.data() + 17), 9600u);
  EXPECT_EQ(read_number<std::uint32_t>(frame.data() + 21), 1'000'000u) << "100 ms in units of 100 ns";
}

TEST(UsbDescriptors, WordsOfFourBytesMakeNoCamera) {
  const Descriptors made = make_descriptors(kScanner);
  EXPECT_EQ(made.configuration[4], 1);
  EXPECT_EQ(parts_of(made.configuration).size(), 3u);
  SimulatedUsbDevice device(kScanner);
  EXPECT_FALSE(device.control({0xA1, 0x81, 0x0100, kCameraInterface, 34}, {}));
  EXPECT_FALSE(device.has_interface(kCameraInterface));
}

TEST(UsbControl, DescriptorsAreCutToWhatTheHostHasRoomFor) {
  SimulatedUsbDevice device(kCamera);
  const auto head = device.control({0x80, 6, 0x0200, 0, 9}, {});
  ASSERT_TRUE(head);
  EXPECT_EQ(head->size(), 9u);
  const auto whole = device.control({0x80, 6, 0x0200, 0, 0xFFFF}, {});
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->size(), read_number<std::uint16_t>(head->data() + 2));
  const auto name = device.control({0x80, 6, 0x0301, 0x0409, 255}, {});
  ASSERT_TRUE(name);
  EXPECT_EQ(name->size(), 2 + 2 * kCamera.device.size());
  EXPECT_EQ((*name)[2], 's');
  EXPECT_FALSE(device.control({0x80, 6, 0x0201, 0, 255}, {})) << "no second configuration";
  EXPECT_FALSE(device.control({0x80, 6, 0x0F00, 0, 255}, {})) << "no BOS";
}

TEST(UsbControl, TheScannerSaysItsProtocolAndStartsOnDemand) {
  SimulatedUsbDevice device(kCamera);
  const auto info = device.control({0xC1, 1, 0, kScannerInterface, kInfoBytes}, {});
  ASSERT_TRUE(info);
  EXPECT_THAT(*info, ElementsAre(1, 0, 0, 0, 0xE0, 0x2E, 0, 0));
  EXPECT_EQ(device.readers(), 0u);
  EXPECT_TRUE(device.control({0x41, 2, 1, kScannerInterface, 0}, {}));
  EXPECT_EQ(device.readers(), 1u);
  EXPECT_TRUE(device.control({0x41, 2, 0, kScannerInterface, 0}, {}));
  EXPECT_EQ(device.readers(), 0u);
  EXPECT_FALSE(device.control({0x41, 2, 2, kScannerInterface, 0}, {}));
  EXPECT_FALSE(device.control({0x41, 2, 1, kCameraInterface, 0}, {}));
  EXPECT_FALSE(device.control({0xC1, 3, 0, kScannerInterface, 8}, {}));
}

TEST(UsbControl, ProbeAndCommitKnowOneFormat) {
  SimulatedUsbDevice device(kCamera);
  const auto length = device.control({0xA1, 0x85, 0x0100, kCameraInterface, 2}, {});
  ASSERT_TRUE(length);
  EXPECT_THAT(*length, ElementsAre(34, 0));
  Bytes proposal(34, 0x55);
  EXPECT_TRUE(device.control({0x21, 0x01, 0x0100, kCameraInterface, 34}, proposal));
  for (const int request : {0x81, 0x82, 0x83, 0x87}) {
    const auto probe = device.control({0xA1, static_cast<std::uint8_t>(request), 0x0100, kCameraInterface, 34}, {});
    ASSERT_TRUE(probe);
    ASSERT_EQ(probe->size(), 34u);
    EXPECT_EQ((*probe)[2], 1);
    EXPECT_EQ((*probe)[3], 1);
    EXPECT_EQ(read_number<std::uint32_t>(probe->data() + 4), 1'000'000u);
    EXPECT_EQ(read_number<std::uint32_t>(probe->data() + 18), 9600u);
    EXPECT_EQ(read_number<std::uint32_t>(probe->data() + 22), 9602u);
  }
  EXPECT_TRUE(device.control({0x21, 0x01, 0x0200, kCameraInterface, 34}, proposal));
  proposal.resize(25);
  EXPECT_FALSE(device.control({0x21, 0x01, 0x0100, kCameraInterface, 25}, proposal));
  EXPECT_FALSE(device.control({0xA1, 0x81, 0x0500, kCameraInterface, 34}, {}));
  const auto error = device.control({0xA1, 0x81, 0x0200, kCameraControlInterface, 1}, {});
  ASSERT_TRUE(error);
  EXPECT_THAT(*error, ElementsAre(6)) << "invalid control";
}

/// A pipe with a message that is under way as soon as it is asked for.
struct PipeTest : ::testing::Test {
  int pump(LinkState link = {}, Duration after = Duration{0}) {
    return pipe.pump(link, MonotonicTime{} + after, host.sink);
  }
  Host host;
  BulkPipe pipe{0x81};
};

TEST_F(PipeTest, AMessageEndsWithAShortTransfer) {
  for (std::uint64_t id = 1; id <= 3; ++id) pipe.ask(id, 1024);
  ASSERT_TRUE(pipe.offer(bytes_of(1500)));
  EXPECT_EQ(pump(), 1);
  ASSERT_EQ(host.answers.size(), 2u);
  EXPECT_EQ(host.answers[0].bytes.size(), 1024u);
  EXPECT_EQ(host.answers[1].bytes.size(), 476u);
  EXPECT_EQ(host.answers[1].id, 2u);
  EXPECT_EQ(host.joined(), *bytes_of(1500));
}

TEST_F(PipeTest, AMessageOfFullPacketsEndsWithAZlp) {
  for (std::uint64_t id = 1; id <= 3; ++id) pipe.ask(id, 1024);
  ASSERT_TRUE(pipe.offer(bytes_of(2048)));
  EXPECT_EQ(pump(), 1);
  ASSERT_EQ(host.answers.size(), 3u);
  EXPECT_TRUE(host.answers[2].bytes.empty());
  EXPECT_EQ(host.answers[2].status, TransferStatus::success);
}

TEST_F(PipeTest, ATransferWithRoomLeftIsShortByItself) {
  pipe.ask(1, 4096);
  pipe.ask(2, 4096);
  ASSERT_TRUE(pipe.offer(bytes_of(1024)));
  EXPECT_EQ(pump(), 1);
  EXPECT_EQ(host.answers.size(), 1u) << "no ZLP";
}

TEST_F(PipeTest, ATransferOfBrokenPacketsOverflowsInsideAMessage) {
  pipe.ask(1, 1000);
  ASSERT_TRUE(pipe.offer(bytes_of(1500)));
  EXPECT_EQ(pump(), 0);
  ASSERT_EQ(host.answers.size(), 1u);
  EXPECT_EQ(host.answers[0].status, TransferStatus::babble);
}

TEST_F(PipeTest, ANewerMessageReplacesOneThatHasNotBegunAndNoOther) {
  ASSERT_TRUE(pipe.offer(bytes_of(600, 1)));
  EXPECT_FALSE(pipe.offer(bytes_of(600, 2))) << "one of the two is superseded";
  pipe.ask(1, 512);
  EXPECT_EQ(pump(), 0);
  EXPECT_EQ(host.answers.at(0).bytes[0], 2);
  EXPECT_FALSE(pipe.offer(bytes_of(600, 3)));
  pipe.ask(2, 512);
  EXPECT_EQ(pump(), 1);
  EXPECT_EQ(host.joined(), *bytes_of(600, 2));
}

TEST_F(PipeTest, ACancelledTransferTakesNothingWithIt) {
  pipe.ask(1, 512);
  pipe.ask(2, 2048);
  pipe.cancel(1, host.sink);
  pipe.cancel(7, host.sink);
  ASSERT_EQ(host.answers.size(), 1u);
  EXPECT_EQ(host.answers[0].status, TransferStatus::cancelled);
  ASSERT_TRUE(pipe.offer(bytes_of(600)));
  EXPECT_EQ(pump(), 1);
  EXPECT_EQ(host.joined(), *bytes_of(600));
}

TEST_F(PipeTest, AHaltedPipeStallsEveryTransfer) {
  pipe.ask(1, 512);
  pipe.ask(2, 512);
  pipe.halt();
  ASSERT_TRUE(pipe.offer(bytes_of(100)));
  EXPECT_EQ(pump(), 0);
  ASSERT_EQ(host.answers.size(), 2u);
  EXPECT_EQ(host.answers[1].status, TransferStatus::stall);
  pipe.clear_halt();
  pipe.ask(3, 512);
  EXPECT_EQ(pump(), 1);
}

TEST_F(PipeTest, BabbleHappensOnce) {
  pipe.ask(1, 512);
  pipe.ask(2, 512);
  pipe.babble_next();
  ASSERT_TRUE(pipe.offer(bytes_of(100)));
  EXPECT_EQ(pump(), 1);
  ASSERT_EQ(host.answers.size(), 2u);
  EXPECT_EQ(host.answers[0].status, TransferStatus::babble);
  EXPECT_EQ(host.answers[1].bytes, *bytes_of(100));
}

TEST_F(PipeTest, AFrozenPipeAnswersNothingAndASlowOneInTime) {
  using std::chrono::milliseconds;
  pipe.ask(1, 512);
  pipe.ask(2, 512);
  ASSERT_TRUE(pipe.offer(bytes_of(1000)));
  EXPECT_EQ(pump({.frozen = true}), 0);
  EXPECT_EQ(pump({.unplugged = true}), 0);
  const LinkState slow{.frame_time = milliseconds(100)};
  EXPECT_EQ(pump(slow), 0);
  EXPECT_FALSE(pipe.offer(bytes_of(1000, 1))) << "it is on its way, though no byte has arrived";
  EXPECT_EQ(pump(slow, milliseconds(51)), 0);
  EXPECT_TRUE(host.answers.empty()) << "510 bytes may have left";
  EXPECT_EQ(pump(slow, milliseconds(52)), 0);
  EXPECT_EQ(host.answers.size(), 1u);
  EXPECT_EQ(pump(slow, milliseconds(99)), 0);
  EXPECT_EQ(pump(slow, milliseconds(100)), 1);
  EXPECT_EQ(host.joined(), *bytes_of(1000));
}

/// A device whose host has asked for both streams.
struct DeviceTest : ::testing::Test {
  DeviceTest() {
    EXPECT_TRUE(device.set_configuration(1, host.sink));
    EXPECT_TRUE(device.control({0x41, 2, 1, kScannerInterface, 0}, {}));
    ask_both();
  }
  void ask_both() {
    device.ask(kFrameEndpoint, ++id, 1 << 16, host.sink);
    device.ask(kCameraEndpoint, ++id, 1 << 16, host.sink);
  }
  void send(std::uint8_t mark, bool damaged = false) {
    device.send({bytes_of(100, mark), bytes_of(9600, mark), damaged});
    device.pump({}, {}, host.sink);
  }
  std::uint64_t id = 0;
  Host host;
  SimulatedUsbDevice device{kCamera};
};

TEST_F(DeviceTest, OneFrameGoesOutOnBothEndpoints) {
  EXPECT_EQ(device.readers(), 2u);
  send(1);
  ASSERT_EQ(host.answers.size(), 2u);
  EXPECT_EQ(host.answers[0].endpoint, kFrameEndpoint);
  EXPECT_EQ(host.answers[0].bytes, *bytes_of(100, 1));
  EXPECT_EQ(host.answers[1].endpoint, kCameraEndpoint);
  EXPECT_EQ(host.answers[1].bytes.size(), 9602u);
  EXPECT_EQ(host.answers[1].bytes[0], 2) << "header length";
  EXPECT_EQ(host.answers[1].bytes[2], 1);
  EXPECT_EQ(device.counters().sent, 2u);
  EXPECT_EQ(device.counters().readers, 2u);
  EXPECT_FALSE(device.busy());
}

TEST_F(DeviceTest, ImagesTellThemselvesApart) {
  send(1);
  ask_both();
  send(2, true);
  const auto flags = [this](std::size_t i) { return host.answers.at(i).bytes[1]; };
  EXPECT_NE(flags(1) & 1, flags(3) & 1) << "frame id";
  EXPECT_EQ(flags(1) & 0x42, 0x02) << "end of frame, no error";
  EXPECT_EQ(flags(3) & 0x42, 0x42) << "end of frame, error";
}

TEST_F(DeviceTest, AnImageInPlaceOfAnotherHasItsFrameId) {
  send(1);
  device.send({bytes_of(100, 2), bytes_of(9600, 2)});
  device.send({bytes_of(100, 3), bytes_of(9600, 3)});
  EXPECT_EQ(device.counters().superseded, 2u);
  ask_both();
  device.pump({}, {}, host.sink);
  EXPECT_NE(host.answers.at(1).bytes[1] & 1, host.answers.at(3).bytes[1] & 1);
  EXPECT_EQ(host.answers.at(3).bytes[2], 3);
}

TEST_F(DeviceTest, ClearingTheHaltEndsTheVideoButNotTheScanner) {
  EXPECT_TRUE(device.control({0x02, 1, 0, kCameraEndpoint, 0}, {}));
  EXPECT_EQ(device.readers(), 1u);
  EXPECT_TRUE(device.control({0x02, 1, 0, kFrameEndpoint, 0}, {}));
  EXPECT_EQ(device.readers(), 1u);
}

TEST_F(DeviceTest, AStallShowsInTheStatusAndEndsWithTheClearedHalt) {
  device.stall();
  send(1);
  EXPECT_EQ(host.answers.at(0).status, TransferStatus::stall);
  EXPECT_THAT(*device.control({0x82, 0, 0, kFrameEndpoint, 2}, {}), ElementsAre(1, 0));
  EXPECT_TRUE(device.control({0x02, 1, 0, kFrameEndpoint, 0}, {}));
  EXPECT_THAT(*device.control({0x82, 0, 0, kFrameEndpoint, 2}, {}), ElementsAre(0, 0));
  ask_both();
  send(2);
  EXPECT_EQ(host.answers.at(2).bytes, *bytes_of(100, 2)) << "a message begins anew";
}

TEST_F(DeviceTest, AResetForgetsReadersAndTransfers) {
  device.reset(host.sink);
  ASSERT_EQ(host.answers.size(), 2u);
  EXPECT_EQ(host.answers[0].status, TransferStatus::cancelled);
  EXPECT_EQ(device.readers(), 0u);
  EXPECT_EQ(device.configuration(), 0);
  send(1);
  EXPECT_EQ(device.counters().unread, 1u);
}

TEST_F(DeviceTest, WhatItDoesNotHaveIsRefused) {
  EXPECT_FALSE(device.set_configuration(2, host.sink));
  EXPECT_FALSE(device.set_alternate(kCameraInterface, 1, host.sink));
  EXPECT_FALSE(device.set_alternate(3, 0, host.sink));
  device.ask(0x83, 99, 512, host.sink);
  ASSERT_EQ(host.answers.size(), 1u);
  EXPECT_EQ(host.answers[0].status, TransferStatus::invalid);
  EXPECT_FALSE(device.control({0x02, 1, 0, 0x83, 0}, {}));
}

}  // namespace
}  // namespace scree::drivers::usb
