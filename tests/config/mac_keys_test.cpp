// publish.keys: what is taken, where a fault is reported, and that a key is shown nowhere.

#include "config/mac_keys.hpp"

#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loader.hpp"
#include "tests/support/process.hpp"

namespace scree::config {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kDigits = "00112233445566778899aabbccddeeff0123456789ABCDEF0123456789abcdef";

std::string with_keys(const std::string& list) {
  return "publish:\n  keys: " + list + "\n";
}
std::string fault_of(const std::string& list) {
  const auto settings = parse_settings(with_keys(list), "robot.yaml");
  return settings ? "(accepted)" : settings.error().message;
}

TEST(MacKeys, TwoKeysInTheOrderGiven) {
  const auto settings = parse_settings(
      with_keys("[{id: 65535, hex: " + kDigits + "}, {hex: \"" + std::string(64, '7') + "\", id: 1}]"), "robot.yaml");
  ASSERT_TRUE(settings) << settings.error().message;
  ASSERT_EQ(settings->publish.keys.size(), 2u);
  EXPECT_EQ(settings->publish.keys[0].id, 65535);
  EXPECT_EQ(settings->publish.keys[0].bytes[1], 0x11);
  EXPECT_EQ(settings->publish.keys[0].bytes[23], 0xEF);
  EXPECT_EQ(settings->publish.keys[1].id, 1);
  EXPECT_EQ(settings->publish.keys[1].bytes[31], 0x77);
}

TEST(MacKeys, FaultsAreReportedWhereTheyStand) {
  const std::string good = "{id: 1, hex: " + kDigits + "}";
  EXPECT_THAT(fault_of("[{id: 1, hex: " + kDigits.substr(1) + "}]"),
              HasSubstr("robot.yaml:2:23: publish.keys: expected 64 hexadecimal digits, found 63 characters"));
  EXPECT_THAT(fault_of("[{id: 1, hex: g" + kDigits.substr(1) + "}]"), HasSubstr("found another character at place 1"));
  EXPECT_THAT(fault_of("[{id: 0, hex: " + kDigits + "}]"),
              HasSubstr("robot.yaml:2:15: publish.keys: expected an id from 1 to 65535, found 0"));
  EXPECT_THAT(fault_of("[{id: 65536, hex: " + kDigits + "}]"), HasSubstr("found 65536"));
  EXPECT_THAT(fault_of("[" + good + ", " + good + "]"), HasSubstr("another id than the first key's, found 1 again"));
  EXPECT_THAT(fault_of("[" + good + ", {id: 2, hex: " + kDigits + "}, {id: 3, hex: " + kDigits + "}]"),
              HasSubstr("a list of at most 2 keys, found 3"));
  for (const char* list : {"[{id: 1}]", "[{id: 1, hex: a, file: b}]", "[{id: 1, hex: a, extra: b}]", "[7]",
                           "[{id: 1, id: 1, hex: a}]", "{id: 1, hex: a}", "7"})
    EXPECT_THAT(fault_of(list), HasSubstr("publish.keys: expected a ")) << list;
}

TEST(MacKeys, FileHoldsTheDigits) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.key";
  std::ofstream(file) << kDigits << "\n";
  const auto settings = parse_settings(with_keys("[{id: 5, file: " + file.string() + "}]"), "robot.yaml");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->publish.keys[0].bytes[2], 0x22);
  EXPECT_THAT(fault_of("[{id: 5, file: /nowhere/map.key}]"),
              HasSubstr("robot.yaml:2:24: publish.keys: expected a file of 64 hexadecimal digits, found "
                        "/nowhere/map.key: expected a key file, found no such file"));
  EXPECT_THAT(fault_of("[{id: 5, file: /dev/zero}]"), HasSubstr("found no regular file"));
  std::ofstream(file) << kDigits << "0";
  EXPECT_THAT(fault_of("[{id: 5, file: " + file.string() + "}]"), HasSubstr("found 65 characters"));
}

TEST(MacKeys, AreShownNowhere) {
  const auto settings = parse_settings(with_keys("[{id: 1, hex: " + kDigits + "}]"), "robot.yaml");
  ASSERT_TRUE(settings);
  const std::string dump = dump_settings(*settings);
  EXPECT_THAT(dump, HasSubstr("keys: [{id: 1, hex: hidden}]"));
  EXPECT_THAT(dump, Not(HasSubstr(kDigits.substr(0, 8))));
  // a dump does not load with a key that nobody chose
  const auto again = parse_settings(dump, "dumped");
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message,
              HasSubstr("64 hexadecimal digits, found 'hidden', which stands for them in a dump"));
  for (const std::string& bad : {kDigits + "0", fmt::format("x{}", kDigits.substr(1))})
    EXPECT_THAT(fault_of("[{id: 1, hex: " + bad + "}]"), Not(HasSubstr(kDigits.substr(2, 8))));
  const auto from_file = write_keys({{7, {}, "/etc/scree/map.key"}});
  EXPECT_EQ(from_file, "[{id: 7, file: \"/etc/scree/map.key\"}]");
}

TEST(MacKeys, NodeListensNotOnEveryAddress) {
  const auto settings = parse_settings("publish: {listen: \"0.0.0.0:47801\"}\n", "robot.yaml");
  ASSERT_FALSE(settings);
  EXPECT_THAT(settings.error().message, HasSubstr("robot.yaml:1:19: publish.listen: expected IPv4-ADDRESS:PORT of this "
                                                  "machine (not 0.0.0.0"));
}

}  // namespace
}  // namespace scree::config
