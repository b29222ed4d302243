#pragma once
// `scree run` as a child process and, in the test's own process, what hears it.

#include <chrono>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "node/listener.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Hears everything.
class Ear {
 public:
  Ear() : Ear(std::nullopt) {}
  /// What is signed with `key` alone.
  explicit Ear(const std::optional<node::protocol::Key>& key) {
    node::ListenerConfig config;
    config.address = "127.0.0.1:0";
    config.accept = {drivers::Origin::live, drivers::Origin::replay, drivers::Origin::sim};
    if (key) {
      EXPECT_TRUE(config.keys.add(*key));
    }
    auto opened = node::Listener::open(config);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    if (opened) listener_ = *std::move(opened);
  }

  std::string address() const { return "127.0.0.1:" + std::to_string(listener_->port()); }
  const node::Listener& operator*() const { return *listener_; }
  const node::Listener* operator->() const { return listener_.get(); }
  std::size_t measured_cells() const {
    const auto map = listener_->last_valid_map();
    return map == nullptr ? 0 : map->measured_cells();
  }

  /// Listens until `reached` holds, at most for `limit`: ample, as sanitizers make the node ten times slower.
  bool until(const std::function<bool()>& reached, milliseconds limit = seconds(120)) {
    const auto deadline = MonotonicClock::now() + limit;
    while (!reached()) {
      if (MonotonicClock::now() > deadline || !listener_->poll(milliseconds(5))) return false;
    }
    return true;
  }
  /// Any of `bits` set, or none of them.
  bool until_health(std::uint16_t bits, bool set) {
    return until([&] { return listener_->heartbeat() && ((listener_->health() & bits) != 0) == set; });
  }
  bool until_bye() {
    return until([&] { return listener_->ended(); });
  }

 private:
  std::unique_ptr<node::Listener> listener_;
};

/// The words that start `scree run` and send its map to `ear`.
inline std::vector<std::string> live(const std::filesystem::path& config, const Ear& ear,
                                     std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"run",           "--config",
                                     config.string(), "--json",
                                     "--set",         "publish.listen=127.0.0.1:0",
                                     "--set",         "publish.destination=" + ear.address()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return command(std::move(arguments));
}

/// From the line that names the port of the kernel's choice.
inline std::string listening_address(const std::string& log) {
  const std::string mark = "listening at ";
  const std::size_t begin = log.find(mark) + mark.size();
  return log.substr(begin, log.find_first_of(",\n", begin) - begin);
}

/// How often `text` stands in `whole`.
inline int occurrences(const std::string& whole, const std::string& text) {
  int count = 0;
  for (std::size_t at = whole.find(text); at != std::string::npos; at = whole.find(text, at + 1)) ++count;
  return count;
}

}  // namespace scree::test
