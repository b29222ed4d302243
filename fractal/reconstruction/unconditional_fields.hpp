#pragma once
// Exact unconditional fBm on a window, one after the other, with everything that they share made once.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/fbm_embedding.hpp"

namespace scree::fractal {

class UnconditionalFields {
 public:
  /// Unit variogram r^(2H), r in cells. Errors: usage (H outside .05 … .95, a window too large for the embedding).
  static Result<UnconditionalFields> make(double hurst, int rows, int columns);

  /// Field k of `seed`, any constant; depends on nothing else. Safe from many threads. Cost: as of fbm_surface.
  Grid<float> field(std::uint64_t seed, int k) const;

  /// Largest diagonal in cells for this H.
  static int max_diagonal(double hurst);

 private:
  FbmEmbedding embedding_;
  int rows_ = 0, columns_ = 0;
};

}  // namespace scree::fractal
