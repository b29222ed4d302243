#include "config/loader.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <string>

namespace scree::config {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string faults_of(std::string_view text, const std::vector<std::string>& assignments = {}) {
  const auto settings = parse_settings(text, "robot.yaml", assignments);
  if (settings) return "(accepted)";
  EXPECT_EQ(settings.error().kind, ErrorKind::bad_config);
  return settings.error().message;
}

TEST(SettingsLoader, EmptyTextGivesTheDefaults) {
  const auto settings = parse_settings("", "empty.yaml");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(dump_settings(*settings), dump_settings(Settings{}));
}

TEST(SettingsLoader, ShippedDefaultSpellsOutTheDefaults) {
  const auto settings = load_settings(SCREE_SOURCE_DIR "/config/default.yaml", {});
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(dump_settings(*settings), dump_settings(Settings{}));
}

TEST(SettingsLoader, EveryShippedFileLoads) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SCREE_SOURCE_DIR "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    const auto settings = load_settings(entry.path(), {});
    EXPECT_TRUE(settings) << settings.error().message;
    ++files;
  }
  EXPECT_GE(files, 6);
}

TEST(SettingsLoader, DumpLoadsBackToItself) {
  for (const char* name : {"default", "perceptron_usf", "perceptron_cmu", "spherical", "pinhole", "demo"}) {
    const auto first = load_settings(fmt::format("{}/config/{}.yaml", SCREE_SOURCE_DIR, name), {});
    ASSERT_TRUE(first) << first.error().message;
    const std::string text = dump_settings(*first);
    const auto second = parse_settings(text, "dumped");
    ASSERT_TRUE(second) << second.error().message;
    EXPECT_EQ(dump_settings(*second), text);
  }
}

TEST(SettingsLoader, MissingFileIsNoInput) {
  const auto settings = load_settings("/nowhere/robot.yaml", {});
  ASSERT_FALSE(settings);
  EXPECT_EQ(settings.error().kind, ErrorKind::no_input);
  EXPECT_THAT(settings.error().message, HasSubstr("/nowhere/robot.yaml: expected a configuration file"));
}

TEST(SettingsLoader, ReportsEveryFaultAtOnceWithItsPosition) {
  const std::string faults = faults_of(
      "map:\n"
      "  cell_m: wide\n"
      "  cel_m: 0.2\n"
      "  size_cells: 100000\n"
      "  size_cells: 100\n"
      "node: 3\n"
      "publish:\n"
      "  listen: \"localhost\"\n"
      "pose:\n"
      "  source: gps\n");
  EXPECT_THAT(faults, HasSubstr("robot.yaml:2:11: map.cell_m: expected a number from 0.005 to 10, found 'wide'\n"));
  EXPECT_THAT(
      faults,
      HasSubstr("robot.yaml:3:3: map.cel_m: expected a known key (nearest: map.cell_m), found an unknown one\n"));
  EXPECT_THAT(faults,
              HasSubstr("robot.yaml:4:15: map.size_cells: expected an integer from 16 to 2048, found '100000'\n"));
  EXPECT_THAT(faults,
              HasSubstr("robot.yaml:5:3: map.size_cells: expected each key once, found it again (first in line 4)\n"));
  EXPECT_THAT(faults, HasSubstr("robot.yaml:6:1: node: expected a section of keys, found '3'\n"));
  EXPECT_THAT(faults, HasSubstr("robot.yaml:8:11: publish.listen: expected IPv4-ADDRESS:PORT of this machine (not "
                                "0.0.0.0; port 0 = any free one), "
                                "found the text \"localhost\""));
  EXPECT_THAT(faults, HasSubstr("robot.yaml:10:11: pose.source: expected one of recording, static, udp, found 'gps'"));
}

TEST(SettingsLoader, ContradictionsHaveThePositionOfAKeyThatWasGiven) {
  EXPECT_THAT(faults_of("map: {size_cells: 20}\nvehicle:\n  wheelbase_m: 40\n"),
              HasSubstr("robot.yaml:1:7: map.size_cells"));
  EXPECT_THAT(faults_of("node:\n  sensor_stale_ms: 5000\n"), HasSubstr("robot.yaml:2:3: node.sensor_stale_ms"));
  EXPECT_THAT(faults_of("source: {kind: recording}\n"), HasSubstr("robot.yaml:1:10: source.kind"));
  EXPECT_THAT(faults_of("pose: {T_map_body: {qw: 0.5}}\n"), HasSubstr("expected qx qy qz qw of norm 1"));
}

TEST(SettingsLoader, ContradictionsAreReportedBesideUnknownKeysAndWrongTypes) {
  const std::string faults = faults_of(
      "map: {cel_m: 0.2, size_cells: 20}\n"
      "vehicle: {wheelbase_m: 40, track_m: wide}\n"
      "node: {threads: many, sensor_stale_ms: 5000}\n"
      "source: {kind: recording}\n"
      "sensor:\n"
      "  projection: cloud\n"
      "  range_min_m: 9\n"
      "  range_max_m: 3\n"
      "  parameters: {fx_px: 500}\n",
      {"publish.refresh_ms=soon"});
  EXPECT_THAT(faults, HasSubstr("robot.yaml:1:7: map.cel_m: expected a known key"));
  EXPECT_THAT(faults, HasSubstr("robot.yaml:3:17: node.threads: expected an integer"));
  EXPECT_THAT(faults, HasSubstr("--set: publish.refresh_ms: expected an integer"));
  EXPECT_THAT(faults,
              HasSubstr("robot.yaml:3:23: node.sensor_stale_ms: expected sensor_stale_ms of at most sensor_lost_ms"));
  EXPECT_THAT(faults, HasSubstr("path with kind recording"));
  EXPECT_THAT(faults, HasSubstr("robot.yaml:8:3: sensor.range_max_m: expected range_min_m below range_max_m"));
  EXPECT_THAT(faults, HasSubstr("sensor.parameters.fx_px: expected projection pinhole, found another one"));
  EXPECT_THAT(faults, Not(HasSubstr("two vehicle lengths"))) << "track_m is faulty: nobody knows the vehicle's length";
}

TEST(SettingsLoader, NothingIsConcludedFromAFaultyValue) {
  const std::string projection = faults_of("sensor:\n  projection: pinhol\n  parameters: {fx_px: 500, fy_px: 500}\n");
  EXPECT_THAT(projection, HasSubstr("sensor.projection: expected one of"));
  EXPECT_THAT(projection, Not(HasSubstr("fx_px:"))) << "with the projection meant they may well apply";
  const std::string limits = faults_of("node: {sensor_lost_ms: none, sensor_stale_ms: 5000}\n");
  EXPECT_THAT(limits, Not(HasSubstr("at most sensor_lost_ms")));
  const std::string section = faults_of("vehicle: 3\nmap: {size_cells: 16}\n");
  EXPECT_THAT(section, Not(HasSubstr("two vehicle lengths")));
}

TEST(SettingsLoader, NoTextBecomesANumberInSilence) {
  for (const char* value :
       {"\"0.2\"", "0,2", "0.2m", ".nan", ".inf", "nan", "inf", "1e999", "", "~", "[0.2]", "{a: 1}", "0x10", "true"})
    EXPECT_THAT(faults_of(fmt::format("map:\n  cell_m: {}\n", value)), HasSubstr("map.cell_m: expected a number"))
        << value;
  for (const char* value : {"2.0", "2e0", "99999999999999999999", "two", "010", "-01", "00", "+07"})
    EXPECT_THAT(faults_of(fmt::format("node:\n  threads: {}\n", value)), HasSubstr("node.threads: expected an integer"))
        << value;
  for (const char* value : {"yes", "1", "\"true\""})
    EXPECT_THAT(faults_of(fmt::format("source:\n  loop: {}\n", value)),
                HasSubstr("source.loop: expected true or false"))
        << value;
}

TEST(SettingsLoader, AssignmentsOverrideTheFileUnderTheSameRules) {
  const auto settings = parse_settings("node:\n  threads: 4\n", "robot.yaml",
                                       {"node.threads=2", "publish.listen=127.0.0.1:0", "pose.T_map_body.z_m=-1.5"});
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->node.threads, 2);
  EXPECT_EQ(settings->publish.listen, "127.0.0.1:0");
  EXPECT_EQ(settings->pose.T_map_body.translation_m.z(), -1.5);

  const std::string faults = faults_of("map:\n  cell_m: x\n", {"node.threads=0", "node.thread=2", "nothing", "=3"});
  EXPECT_THAT(faults, HasSubstr("robot.yaml:2:11: map.cell_m"));
  EXPECT_THAT(faults, HasSubstr("--set: node.threads: expected an integer from 1 to 64, found '0'"));
  EXPECT_THAT(faults, HasSubstr("--set: node.thread: expected a known key (nearest: node.threads)"));
  EXPECT_THAT(faults, HasSubstr("--set: (assignment): expected key=value, found 'nothing'"));
}

TEST(SettingsLoader, SyntaxErrorsAndSecondDocumentsAreFaults) {
  EXPECT_THAT(faults_of("map: [1, 2\n"), HasSubstr("robot.yaml:"));
  EXPECT_THAT(faults_of("map: {}\n---\nnode: {}\n"), HasSubstr("expected one YAML document"));
  EXPECT_THAT(faults_of("- a\n- b\n"), HasSubstr("(top): expected a map of sections, found a list of 2"));
}

// A comma outside of brackets: yaml-cpp reads documents without end from it.
TEST(SettingsLoader, StrayCommaIsAFault) {
  for (const char* text : {",", "map: {cell_m: 0.1}\n,", ",map: {}"})
    EXPECT_EQ(parse_settings(text, "x.yaml").error().kind, ErrorKind::bad_config) << text;
}

TEST(SettingsLoader, AliasBombIsRefused) {
  std::string text = "a0: &a0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 12; ++i)
    text += fmt::format("a{0}: &a{0} [*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1}]\n", i, i - 1);
  EXPECT_THAT(faults_of(text), HasSubstr("expected at most 100000 values"));
}

TEST(EffectiveSensor, SingleKeysOverrideARecordingAndAProjectionReplacesIt) {
  SensorConfig recorded;
  recorded.projection.kind = ProjectionKind::pinhole;
  recorded.projection.fx_px = recorded.projection.fy_px = 500;
  recorded.filter.range_max_m = 7;

  const auto some = parse_settings("sensor:\n  range_min_m: 2\n  parameters: {fx_px: 600}\n", "robot.yaml");
  ASSERT_TRUE(some) << some.error().message;
  const auto merged = effective_sensor(*some, recorded);
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_EQ(merged->projection.kind, ProjectionKind::pinhole);
  EXPECT_EQ(merged->projection.fx_px, 600);
  EXPECT_EQ(merged->projection.fy_px, 500);
  EXPECT_EQ(merged->filter.range_min_m, 2);
  EXPECT_EQ(merged->filter.range_max_m, 7);

  const auto whole = parse_settings("sensor:\n  projection: cloud\n  range_min_m: 2\n", "robot.yaml");
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(effective_sensor(*whole, recorded)->filter.range_max_m, FilterConfig{}.range_max_m);
}

TEST(EffectiveSensor, ContradictionWithTheRecordingIsReported) {
  SensorConfig recorded;
  recorded.filter.range_max_m = 7;
  const auto settings = parse_settings("sensor:\n  range_min_m: 8\n", "robot.yaml");
  ASSERT_TRUE(settings);
  const auto merged = effective_sensor(*settings, recorded);
  ASSERT_FALSE(merged);
  EXPECT_THAT(merged.error().message, HasSubstr("range_min_m below range_max_m"));
}

TEST(SensorKeys, ParameterOfAnotherProjectionIsAFault) {
  EXPECT_THAT(faults_of("sensor:\n  projection: cloud\n  parameters: {fx_px: 500}\n"),
              HasSubstr("robot.yaml:3:16: sensor.parameters.fx_px: expected projection pinhole"));
  EXPECT_THAT(faults_of("sensor:\n  projection: pinhole\n"), HasSubstr("fx_px and fy_px with projection pinhole"));
  EXPECT_THAT(faults_of("sensor:\n  projection: spherical\n"), HasSubstr("row_elevations_rad"));
}

TEST(SensorKeys, LeastReflectanceNeedsThePlaceOfTheReflectance) {
  const char* text = "sensor:\n  projection: perceptron_usf\n  filter: {min_reflectance: 40}\n";
  EXPECT_THAT(faults_of(text), HasSubstr("robot.yaml:3:12: sensor.filter.min_reflectance: expected "
                                         "parameters.reflectance_shift 12 or 16 with filter.min_reflectance"));
  const auto settings = parse_settings(text, "robot.yaml", {"sensor.parameters.reflectance_shift=12"});
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->sensor->filter.min_reflectance, 40);
}

TEST(Documentation, HoldsTheTableOfAllKeys) {
  std::ifstream stream(SCREE_SOURCE_DIR "/docs/configuration.md");
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(page, HasSubstr(settings_table()))
      << "paste the output of `scree config keys` into docs/configuration.md";
}

}  // namespace
}  // namespace scree::config
