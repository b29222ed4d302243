#pragma once
// Frames spoilt on purpose, for tests of what reads them.

#include <cstdint>
#include <span>
#include <vector>

namespace scree::drivers {

inline constexpr int kFlippedBytes = 8;

/// Inverts kFlippedBytes bytes, each in another eighth of `bytes`, at places that `seed` chooses. Fewer if there are
/// not as many.
void flip_bytes(std::span<std::uint8_t> bytes, std::uint64_t seed);

/// `message` is GEOMETRY and FRAME, as stream::Encoder writes them. In place of its GEOMETRY comes one with
/// `geometry_payload`, to which the frame refers as if it were its own: every CRC is right, the sizes contradict.
std::vector<std::uint8_t> with_other_geometry(std::span<const std::uint8_t> message,
                                              std::span<const std::uint8_t> geometry_payload);

}  // namespace scree::drivers
