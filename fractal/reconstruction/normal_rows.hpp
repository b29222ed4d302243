#pragma once
// Many standard normals at once, for samplers that spend their time on them.

#include <cstdint>

namespace scree::fractal {

/// 4·lanes standard normals: lane i gives out[i], out[lanes + i], out[2·lanes + i] and out[3·lanes + i] from one call
/// of the counter-based generator at (seed, stream, i, row), two Box–Muller pairs in float with polynomials for
/// logarithm, sine and cosine (error below 1e-6 relative to the radius). Vectorised over lanes. The same on every
/// machine of one build; |normal| ≤ 5.9.
void normal_block(std::uint64_t seed, std::uint64_t stream, int row, int lanes, float* out);

}  // namespace scree::fractal
