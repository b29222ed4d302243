#pragma once
// The map protocol, version 1: bytes in, values out and back. docs/protocol.md has the offsets, client/golden the
// vectors. A receiver calls open_datagram, then its own stream, origin and sequence checks, then decode.

#include "node/protocol_header.hpp"    // IWYU pragma: export
#include "node/protocol_layers.hpp"    // IWYU pragma: export
#include "node/protocol_mac.hpp"       // IWYU pragma: export
#include "node/protocol_messages.hpp"  // IWYU pragma: export
#include "node/protocol_reject.hpp"    // IWYU pragma: export
#include "node/protocol_requests.hpp"  // IWYU pragma: export
#include "node/protocol_sequence.hpp"  // IWYU pragma: export
#include "node/protocol_tile.hpp"      // IWYU pragma: export
