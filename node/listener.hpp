#pragma once
// A receiver of the map protocol: what `scree listen` shows and what the tests hold against the node.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "mapping/snapshot.hpp"

namespace scree::node {

struct ListenerCounters {
  std::uint64_t datagrams = 0;  ///< received
  std::uint64_t lost = 0;       ///< gaps in seq
  std::uint64_t rejected = 0;   ///< failed a check; sum of `rejected_*`
  std::uint64_t refused_origin = 0;
  std::uint64_t tiles = 0;
};

enum class LinkState : std::uint8_t { waiting, fresh, stale, lost };

class Listener {
 public:
  /// Binds `address` ("127.0.0.1:47800"). Errors: unavailable (port taken), usage.
  static Result<std::unique_ptr<Listener>> open(const std::string& address, std::set<drivers::Origin> accept);
  ~Listener();

  /// Receives for at most `timeout`, then applies the freshness rules. True when something arrived.
  Result<bool> poll(std::chrono::milliseconds timeout);

  LinkState link() const;
  bool ended() const;                             ///< BYE was received
  std::optional<drivers::Origin> origin() const;  ///< of the last accepted datagram
  std::uint16_t health() const;
  const ListenerCounters& counters() const;

  /// The map as received now; every cell unknown when LOST. Null before the first ANNOUNCE.
  std::shared_ptr<const mapping::MapSnapshot> map() const;
  /// The last valid map before it was LOST.
  std::shared_ptr<const mapping::MapSnapshot> last_valid_map() const;

  // from the last HEARTBEAT
  std::uint64_t frames_in() const;
  std::uint64_t frames_dropped() const;
  std::uint32_t latency_p50_us() const;
  std::uint32_t latency_p99_us() const;

 private:
  struct State;
  explicit Listener(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
