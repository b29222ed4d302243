#pragma once
// What `scree top` shows: a node and the way from it, as lines of text.

#include <cstdint>
#include <string>

#include "client/scree_client.hpp"

namespace scree::node {

/// Turns the client's totals into rates: each text covers the time since the last one.
class TopView {
 public:
  /// Lines of at most 78 columns. `now` must grow from call to call.
  std::string text(const client::Client& map, client::Time now);

 private:
  struct Totals {
    std::uint64_t frames = 0, dropped = 0, datagrams = 0, tiles = 0, lost = 0;
    std::uint32_t map_rev = 0;
  };
  void take_rates(const client::Client& map, client::Time now);

  bool begun_ = false;
  client::Time last_;
  std::uint64_t boot_id_ = 0;
  Totals before_, by_second_milli_;  ///< rates in thousandths a second
};

/// "ok", or the names of the bits that are set.
std::string health_text(std::uint16_t health);

}  // namespace scree::node
