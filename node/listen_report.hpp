#pragma once
// What a listener tells: lines for people, JSON for programs.

#include <optional>
#include <string>

#include "node/listener.hpp"

namespace scree::node {

std::optional<drivers::Origin> parse_origin(const std::string& word);  ///< live | replay | sim | hil
/// "LIVE", "REPLAY", "SIM", "HIL", or "nothing".
const char* origin_name(std::optional<drivers::Origin> origin);

std::string describe_link(const Listener& listener);
std::string listen_line(const Listener& listener, const mapping::MapSnapshot* map);

/// The node's own figures come from its last heartbeat; `points` is null, as they are not sent. `map` may be null.
std::string listen_json(const Listener& listener, const mapping::MapSnapshot* map);

}  // namespace scree::node
