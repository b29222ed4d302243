#pragma once
// Connected surfaces of a range image, and how many ambiguity intervals lie between their pixels.

#include <algorithm>
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
    cores,        ///< through pixels whose 5 × 5 neighbourhood is joined throughout; then the pixels up to four steps
                  ///< from them
    tight_cores,  ///< the same with tight joins only: to split a surface whose evidence contradicts itself
  };

  /// Labels the pixels whose state is `kept`.
  void label(const Grid<PixelState>& state, const ImageEdges& edges, Joining joining);

  /// Row-major index of the root of pixel i's surface; −1 for pixels that were not kept.
  std::int32_t root(std::size_t i) const { return parent_[i]; }
  /// Intervals of pixel i beyond those of its root.
  int wraps(std::size_t i) const { return wraps_[i]; }
  /// Pixels of the surface with this root.
  int size(std::int32_t root) const { return size_[static_cast<std::size_t>(root)]; }
  /// Two ways through the surface with this root disagree about the intervals between their ends: somewhere it is
  /// joined across an edge whose depth is about one interval.
  bool twisted(std::int32_t root) const { return std::binary_search(twisted_.begin(), twisted_.end(), root); }

 private:
  struct Rooted {
    std::int32_t root;
    std::int32_t wraps;  ///< beyond the root's
  };
  struct Attachment {
    std::int32_t pixel;
    Rooted to;
  };

  void join_edges(const ImageEdges& edges);
  void find_quads(const ImageEdges& edges, std::uint8_t needed);
  void find_cores();
  void join_cores(const ImageEdges& edges);
  void grow(const ImageEdges& edges);
  bool attach(const ImageEdges& edges, int row, int column, Rooted& to) const;
  void flatten();
  void measure();
  Rooted find(std::int32_t i);
  void unite(std::int32_t a, std::int32_t b, int wraps_a_to_b);

  int rows_ = 0;
  int columns_ = 0;
  std::vector<std::int32_t> parent_, size_;
  std::vector<std::int32_t> wraps_;    ///< relative to the parent; to the root once flattened
  std::vector<std::int32_t> twisted_;  ///< pixels while joining, sorted roots once measured
  Grid<std::uint8_t> quad_;            ///< 1: the 2 × 2 block right and below is joined and its wraps cancel
  Grid<std::uint8_t> row_of_quads_;    ///< 1: the four quads of a 5-pixel row of quads around this pixel are whole
  Grid<std::uint8_t> core_;            ///< 1: belongs to a core, or was attached to one
  std::vector<Attachment> attachments_;
};

}  // namespace scree
