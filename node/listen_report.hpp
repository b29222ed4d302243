#pragma once
// What a listener tells: lines for people, JSON for programs.

#include <optional>
#include <string>
#include <vector>

#include "node/listener.hpp"

namespace scree::node {

std::optional<drivers::Origin> parse_origin(const std::string& word);  ///< live | replay | sim | hil
/// "LIVE", "REPLAY", "SIM", "HIL", or "nothing".
const char* origin_name(std::optional<drivers::Origin> origin);

std::string describe_link(const Listener& listener);
std::string listen_line(const Listener& listener, const mapping::MapSnapshot* map);

/// Names of the layers that the sender announced and this reader knows: a map has nothing in the others. None while its
/// present boot has announced nothing (the last valid map is then of an earlier one).
std::optional<std::vector<std::string>> announced_layers(const Listener& listener);

/// The node's own figures come from its last heartbeat; `points` is null, as they are not sent. `map` may be null: the
/// keys that speak of it are then null, so that every document has the same ones.
std::string listen_json(const Listener& listener, const mapping::MapSnapshot* map);

}  // namespace scree::node
