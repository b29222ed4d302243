#pragma once
// Holds what a client shows against what was sent: every known cell must be the one of a revision of its tile that was
// sent, the whole block of one and the same.

#include <cstdint>
#include <string>

#include "tests/client/client_port.hpp"
#include "tests/support/map_sender.hpp"

namespace scree::test {

struct Judgement {
  std::uint64_t known = 0;             ///< cells that the client shows
  std::uint64_t unknown = 0;           ///< cells that it shows as unknown
  std::uint64_t wrong = 0;             ///< cells of blocks that agree with no revision
  std::uint32_t revisions_behind = 0;  ///< the most that a shown block's successor is older than the newest revision
  std::string first_wrong;
};

/// Costs, occupancy, elevation and cell state of the whole window.
Judgement judge(const Shown& shown, const MapSender& sender);

/// True when nothing at all is known.
bool all_unknown(const Shown& shown);

}  // namespace scree::test
