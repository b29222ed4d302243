#pragma once
// Connected surfaces of a range image, and how many ambiguity intervals lie between their pixels.

#include <cstdint>
#include <vector>

#include "core/grid.hpp"
#include "drivers/frame/image_edges.hpp"
#include "drivers/frame/pixel_state.hpp"

namespace scree {

/// Union-find over the image with a potential (intervals relative to the root). The root of a surface is its first
/// pixel in row-major order, so labels do not depend on anything but the image.
class Surfaces {
 public:
  enum class Joining : std::uint8_t {
    edges,        ///< every joined edge between kept pixels: unambiguous sensors
    quads,        ///< sides of 2 × 2 blocks whose four edges are joined and whose wraps cancel around the block; tight
                  ///< blocks first, so that doubtful ones cannot overrule them
    tight_quads,  ///< tight blocks only: what is left of a surface whose evidence contradicts itself
  };

  /// Labels the pixels whose state is `kept`.
  void label(const Grid<PixelState>& state, const ImageEdges& edges, Joining joining);

  /// Row-major index of the root of pixel i's surface; −1 for pixels that were not kept.
  std::int32_t root(std::size_t i) const { return parent_[i]; }
  /// Intervals of pixel i beyond those of its root.
  int wraps(std::size_t i) const { return wraps_[i]; }
  /// Pixels of the surface with this root.
  int size(std::int32_t root) const { return size_[static_cast<std::size_t>(root)]; }

 private:
  void join_edges(const ImageEdges& edges);
  void join_quads(const ImageEdges& edges, std::uint8_t needed);
  void flatten();
  struct Rooted {
    std::int32_t root;
    std::int32_t wraps;  ///< beyond the root's
  };
  Rooted find(std::int32_t i);
  void unite(std::int32_t a, std::int32_t b, int wraps_a_to_b);

  int rows_ = 0;
  int columns_ = 0;
  std::vector<std::int32_t> parent_, size_;
  std::vector<std::int32_t> wraps_;  ///< relative to the parent; to the root once flattened
};

}  // namespace scree
