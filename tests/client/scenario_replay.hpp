#pragma once
// Replays one scenario against the C++ client; the Python twin is scenarios_test.py.

#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/scree_client.hpp"
#include "tests/client/scenario.hpp"

namespace scree::test {

class ScenarioReplay {
 public:
  /// One line of a scenario; failures are GoogleTest's.
  void line(const std::vector<std::string>& words);
  const client::Receiver& receiver() const { return *receiver_; }

 private:
  using Words = std::vector<std::string>;
  void configure(const Words& words);
  void open();
  void expect(client::Time now, const std::string& what, const Words& values);
  void expect_cost(client::Time now, long x, long y, int cost);
  void expect_value(client::Time now, client::Layer layer, int x, int y, float value);
  void expect_grid(const Words& values);
  void expect_counter(const std::string& name, std::uint64_t value);
  void expect_request(client::Time now, int type, const std::string& body);
  /// Index of a cell in the window's arrays; -1 outside.
  long index(long x, long y) const;

  client::Config config_;
  std::unique_ptr<client::Receiver> receiver_;
  client::Verdict verdict_ = client::Verdict::accepted;
};

}  // namespace scree::test
