// The scenarios of client/golden/scenarios, which the Python client replays too (scenarios_test.py).

#include <algorithm>

#include "tests/client/scenario_replay.hpp"

namespace scree::test {
namespace {

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(golden_folder() / "scenarios"))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class Scenarios : public testing::TestWithParam<std::string> {};

TEST_P(Scenarios, EveryExpectationHolds) {
  ScenarioReplay replay;
  for (const ScenarioLine& line : read_scenario(golden_folder() / "scenarios" / (GetParam() + ".txt"))) {
    SCOPED_TRACE(GetParam() + ".txt:" + std::to_string(line.number) + ": " + line.text.substr(0, 120));
    replay.line(line.words);
    if (HasFatalFailure()) return;
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t count : replay.receiver().counters().by_verdict) sum += count;
  EXPECT_EQ(replay.receiver().counters().datagrams, sum);
}

INSTANTIATE_TEST_SUITE_P(Golden, Scenarios, testing::ValuesIn(scenario_names()),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace scree::test
