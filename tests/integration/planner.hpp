#pragma once
// A real node, and planners with the C++ client that hear it.

#include <algorithm>
#include <deque>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <tuple>

#include "client/scree_client.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/scree.hpp"
#include "tests/support/udp_relay.hpp"

namespace scree::test {

using client::Clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// `scree run` on a recording of flat ground in a loop; it listening at at a port that it prints.
class Node {
 public:
  explicit Node(std::vector<std::string> more = {}, const std::vector<double>& times_s = every(0.1, 20)) {
    const auto recording = make_depth_recording(folder_ / "drive", times_s, 0.2);
    std::vector<std::string> words{"run",
                                   "--config",
                                   live_config(folder_ / "robot.yaml", recording).string(),
                                   "--set",
                                   "publish.listen=127.0.0.1:0",
                                   "--set",
                                   "source.loop=true"};
    words.insert(words.end(), more.begin(), more.end());
    words_ = command(words);
    start();
  }
  void start() { process_.emplace(words_); }
  Process& process() { return *process_; }
  /// "127.0.0.1:40123", from the log.
  std::string listen_address() {
    EXPECT_TRUE(process_->wait_for_text("listening at")) << process_->err();
    const std::string log = process_->err();
    const std::size_t at = log.find("127.0.0.1:", log.find("listening at"));
    return log.substr(at, log.find_first_not_of("0123456789.:", at) - at);
  }

 private:
  TemporaryFolder folder_;
  std::vector<std::string> words_;
  std::optional<Process> process_;
};

/// A client that takes what the node's recording says it is.
class Planner {
 public:
  explicit Planner(const std::string& node = {}, const client::Key& key = {}) {
    client::Config config;
    config.bind = "127.0.0.1:0";
    config.accept_origins = client::origin_bit(client::Origin::replay);
    if (!node.empty()) config.node = node.c_str();
    config.keys[0] = key;
    EXPECT_TRUE(map.open(config)) << map.error();
  }
  std::string address() const { return "127.0.0.1:" + std::to_string(map.port()); }
  std::size_t known(client::Time now = Clock::now()) const {
    cells_.resize(map.grid().cells());
    if (!map.copy_cost(cells_.data(), cells_.size(), now)) return 0;
    return cells_.size() - static_cast<std::size_t>(std::count(cells_.begin(), cells_.end(), client::kCostUnknown));
  }
  bool until(const std::function<bool()>& reached, milliseconds limit = seconds(120)) {
    const auto deadline = Clock::now() + limit;
    while (!reached()) {
      if (Clock::now() > deadline) return false;
      map.wait(milliseconds(5));
      map.poll();
    }
    return true;
  }
  bool until_known() {
    return until([&] { return map.fresh() && known() > 500; });
  }

  client::Client map;

 private:
  mutable std::vector<std::uint8_t> cells_;
};

inline std::string destination(const std::string& address) {
  return "publish.destination=" + address;
}

inline sockaddr_in loopback(const std::string& port = "0") {
  return *parse_ipv4("127.0.0.1:" + port);
}

/// Every revision that a planner beside the node saw, and whether one behind the relay held it a second later.
class Currency {
 public:
  void look(const client::Client& direct, const client::Client& far, client::Time now) {
    const client::Announce* const a = direct.announce();
    for (int layer = 0; a != nullptr && layer < static_cast<int>(client::kLayers); ++layer)
      for (std::int32_t ty = a->ty_min; ty <= a->ty_max; ++ty)
        for (std::int32_t tx = a->tx_min; tx <= a->tx_max; ++tx)
          note({layer, tx, ty}, direct.tile_rev(static_cast<client::Layer>(layer), tx, ty), now);
    for (; !awaited_.empty() && awaited_.front().due <= now; awaited_.pop_front()) {
      const auto& [layer, tx, ty] = awaited_.front().tile;
      const client::Announce* const b = far.announce();
      if (b == nullptr || tx < b->tx_min || tx > b->tx_max || ty < b->ty_min || ty > b->ty_max) continue;  // moved on
      ++changes;
      missed += far.tile_rev(static_cast<client::Layer>(layer), tx, ty) < awaited_.front().rev;
    }
  }
  std::size_t changes = 0, missed = 0;

 private:
  using Tile = std::tuple<int, std::int32_t, std::int32_t>;
  struct Awaited {
    client::Time due;
    Tile tile;
    std::uint32_t rev;
  };
  void note(const Tile& tile, std::uint32_t rev, client::Time now) {
    if (rev <= seen_[tile]) return;
    seen_[tile] = rev;
    awaited_.push_back({now + seconds(1), tile, rev});
  }
  std::map<Tile, std::uint32_t> seen_;
  std::deque<Awaited> awaited_;
};

}  // namespace scree::test
