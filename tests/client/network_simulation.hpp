#pragma once
// A sender, a bad network in both directions and a client, in simulated time: steps of 1 ms, nothing waits.

#include <functional>

#include "tests/client/oracle.hpp"

namespace scree::test {

struct SimulationSettings {
  MapSenderSettings sender;
  BadNetworkSettings down, up;
  std::uint64_t network_seed = 1;
  Nanoseconds duration = std::chrono::seconds(60);
  Nanoseconds warm_up = std::chrono::seconds(5);  ///< changes before are not judged
  Nanoseconds limit = std::chrono::seconds(1);    ///< within which a change must have arrived
};

struct SimulationResult {
  std::uint64_t changes = 0;  ///< of one layer of one tile
  std::uint64_t missed = 0;   ///< of these, not held after `limit`
  Judgement judgement;        ///< summed over looks every half second
  std::uint64_t looks = 0;
  double share_current() const { return 1.0 - static_cast<double>(missed) / static_cast<double>(changes); }
};

class NetworkSimulation {
 public:
  NetworkSimulation(const SimulationSettings& settings, ClientPort& client);
  /// To the end; calls each_step after every millisecond.
  SimulationResult run(const std::function<void(Nanoseconds)>& each_step = {});
  void set_black_out(bool on);
  const BadNetwork& down() const { return down_; }
  const MapSender& sender() const { return sender_; }
  /// Another sender takes the place of the present one: a node that was killed and started again.
  void replace_sender(const MapSenderSettings& settings);

 private:
  struct Awaited {
    Nanoseconds due;
    std::vector<Change> changes;
  };
  void step(Nanoseconds now);
  void check_changes(Nanoseconds now);
  void look(Nanoseconds now);

  SimulationSettings settings_;
  ClientPort& client_;
  MapSender sender_;
  BadNetwork down_, up_;
  std::deque<Awaited> awaited_;
  SimulationResult result_;
};

}  // namespace scree::test
