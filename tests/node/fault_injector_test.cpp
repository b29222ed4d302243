// A fault script carried out on a device that only writes down what it is told.

#include "node/fault_injector.hpp"

#include <gtest/gtest.h>

#include "drivers/frame_stream.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::node {
namespace {

using drivers::FaultKind;
using std::chrono::milliseconds;

class NotedServer final : public drivers::FrameServer {
 public:
  std::string address() const override { return "noted"; }
  void serve() override {}
  void send(const drivers::ServedFrame&) override {}
  std::size_t readers() const override { return 1; }
  bool busy() const override { return false; }
  const drivers::FrameServerCounters& counters() const override { return counters_; }
  void set_link(const drivers::LinkState& its) override { link = its; }
  void stall() override { ++stalls; }
  void babble() override { ++babbles; }

  drivers::LinkState link;
  int stalls = 0, babbles = 0;

 private:
  drivers::FrameServerCounters counters_;
};

FaultInjector injector(const std::string& script) {
  auto faults = drivers::parse_fault_script(script, "f");
  EXPECT_TRUE(faults) << (faults ? "" : faults.error().message);
  return {*std::move(faults), milliseconds(100), std::vector<std::uint8_t>(248)};
}

std::uint64_t count(const FaultInjector& injector, FaultKind kind) {
  return injector.injected()[static_cast<std::size_t>(kind)];
}

TEST(FaultInjector, AFaultLastsAsLongAsItsLineSays) {
  NotedServer server;
  auto faults = injector("1 unplug 0.5\n1.2 slow 3 1\n3 freeze 0.1");
  EXPECT_TRUE(faults.advance(milliseconds(999), server).empty());
  EXPECT_EQ(server.link, drivers::LinkState{});
  EXPECT_EQ(faults.advance(milliseconds(1000), server).size(), 1u);
  EXPECT_TRUE(server.link.unplugged);
  faults.advance(milliseconds(1499), server);
  EXPECT_TRUE(server.link.unplugged);
  EXPECT_EQ(server.link.frame_time, milliseconds(300)) << "both at a time";
  faults.advance(milliseconds(1500), server);
  EXPECT_FALSE(server.link.unplugged);
  faults.advance(milliseconds(2200), server);
  EXPECT_EQ(server.link, drivers::LinkState{});
  faults.advance(milliseconds(3050), server);
  EXPECT_TRUE(server.link.frozen);
  faults.advance(milliseconds(4000), server);
  EXPECT_EQ(server.link, drivers::LinkState{});
  EXPECT_EQ(count(faults, FaultKind::unplug), 1u);
  EXPECT_EQ(count(faults, FaultKind::slow), 1u);
  EXPECT_EQ(count(faults, FaultKind::freeze), 1u);
  EXPECT_EQ(count(faults, FaultKind::stall), 0u);
}

TEST(FaultInjector, AShorterFaultDoesNotCutALongerOneShort) {
  using drivers::stream::Bytes;
  NotedServer server;
  auto faults = injector(
      "1 unplug 3\n1 freeze 3\n1 wrong_geometry 3\n2 unplug 0.5\n2 freeze 0.5\n2 wrong_geometry 0.5\n"
      "3.5 unplug 1");
  const drivers::ServedFrame good{std::make_shared<const Bytes>(drivers::stream::encoded(
                                      drivers::stream::test_encoder(), drivers::stream::test_frame(0))),
                                  nullptr, false};
  const auto wrong_at = [&](int ms) {
    faults.advance(milliseconds(ms), server);
    return *faults.spoil(good, 0).message != *good.message;
  };
  for (const int ms : {1000, 2000, 2499, 2500, 3999}) {
    EXPECT_TRUE(wrong_at(ms)) << ms;
    EXPECT_TRUE(server.link.unplugged) << ms;
    EXPECT_TRUE(server.link.frozen) << ms;
  }
  EXPECT_FALSE(wrong_at(4000));
  EXPECT_FALSE(server.link.frozen);
  EXPECT_TRUE(server.link.unplugged) << "the later end counts, whichever began first";
  faults.advance(milliseconds(4500), server);
  EXPECT_EQ(server.link, drivers::LinkState{});
  EXPECT_EQ(count(faults, FaultKind::unplug), 3u);
}

TEST(FaultInjector, StallAndBabbleHappenOnce) {
  NotedServer server;
  auto faults = injector("0 stall\n0 babble\n1 stall");
  faults.advance(Duration{0}, server);
  faults.advance(milliseconds(500), server);
  EXPECT_EQ(server.stalls, 1);
  EXPECT_EQ(server.babbles, 1);
  faults.advance(milliseconds(1001), server);
  EXPECT_EQ(server.stalls, 2);
  EXPECT_EQ(count(faults, FaultKind::stall), 2u);
}

TEST(FaultInjector, FramesAreSpoiltOnlyWhileAFaultLasts) {
  using drivers::stream::Bytes;
  NotedServer server;
  auto faults = injector("1 corrupt 2\n2 wrong_geometry 1");
  const drivers::ServedFrame good{std::make_shared<const Bytes>(drivers::stream::encoded(
                                      drivers::stream::test_encoder(), drivers::stream::test_frame(0))),
                                  std::make_shared<const Bytes>(Bytes(24)), false};
  const auto spoilt_at = [&](int ms) {
    faults.advance(milliseconds(ms), server);
    return faults.spoil(good, 0);
  };
  EXPECT_EQ(spoilt_at(0).message, good.message);
  for (int i = 0; i < 2; ++i) {
    const auto corrupt = spoilt_at(1000 + i);
    EXPECT_NE(*corrupt.message, *good.message);
    EXPECT_NE(*corrupt.image, *good.image);
    EXPECT_TRUE(corrupt.image_damaged);
  }
  EXPECT_EQ(spoilt_at(1002).message, good.message);
  const auto wrong = spoilt_at(2999);
  EXPECT_EQ(wrong.message->size(), good.message->size());
  EXPECT_NE(*wrong.message, *good.message);
  EXPECT_EQ(wrong.image->size(), 12u);
  EXPECT_FALSE(wrong.image_damaged);
  EXPECT_EQ(spoilt_at(3000).message, good.message);
  EXPECT_EQ(faults.frames_corrupted(), 2u);
  EXPECT_EQ(faults.frames_of_wrong_geometry(), 1u);
}

}  // namespace
}  // namespace scree::node
