#pragma once
// A client under test: the C++ header in this process, or the Python file in a child process that is fed through pipes.
// Both get the same datagrams at the same times.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/scree_client.hpp"
#include "tests/support/bad_network.hpp"

namespace scree::test {

/// What a client shows of its whole map.
struct Shown {
  client::State state = client::State::waiting;
  client::Grid grid;
  std::vector<std::uint8_t> cost;      ///< copy_cost
  std::vector<std::int8_t> occupancy;  ///< to_occupancy
  std::vector<float> elevation;        ///< copy_layer
  std::vector<float> cell_state;       ///< copy_layer
  std::uint64_t accepted = 0, datagrams = 0;
  std::uint64_t memory = 0;  ///< Python: resident bytes of its process; C++: allocations since open()
};

struct PortSettings {
  bool subscribe = false;
  std::uint8_t repeats = 1;
  std::optional<client::Key> key;
};

class ClientPort {
 public:
  virtual ~ClientPort() = default;
  virtual void accept(std::span<const std::uint8_t> datagram, Nanoseconds now) = 0;
  /// Applies the rules of time and returns the requests that are due.
  virtual std::vector<std::vector<std::uint8_t>> requests(Nanoseconds now) = 0;
  virtual Shown show(Nanoseconds now) = 0;
  /// tile_rev of each layer (cost, elevation, cell_state) of each tile of a rectangle: layer, then row, then column.
  virtual std::vector<std::uint32_t> revisions(std::int32_t tx, std::int32_t ty, int columns, int rows) = 0;
};

std::unique_ptr<ClientPort> cpp_port(const PortSettings& settings);
std::unique_ptr<ClientPort> python_port(const PortSettings& settings);

}  // namespace scree::test
