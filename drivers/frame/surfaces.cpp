#include "drivers/frame/surfaces.hpp"

namespace scree {

void Surfaces::label(const Grid<PixelState>& state, const ImageEdges& edges, Joining joining) {
  rows_ = state.rows();
  columns_ = state.columns();
  parent_.resize(state.size());
  wraps_.assign(state.size(), 0);
  twisted_.clear();
  for (std::size_t i = 0; i < state.size(); ++i)
    parent_[i] = state[i] == PixelState::kept ? static_cast<std::int32_t>(i) : -1;
  if (joining == Joining::edges) {
    join_edges(edges);
    flatten();
  } else {
    find_quads(edges, joining == Joining::cores ? edge::kJoined : edge::kJoined | edge::kTight);
    find_cores();
    join_cores(edges);
    flatten();
    grow(edges);
  }
  measure();
}

/// Path halving; a parent's index is always smaller than its child's, and a root's wraps are 0.
Surfaces::Rooted Surfaces::find(std::int32_t i) {
  std::int32_t wraps = 0;
  while (parent_[i] != i) {
    const std::int32_t parent = parent_[i];
    wraps_[i] += wraps_[parent];
    parent_[i] = parent_[parent];
    wraps += wraps_[i];
    i = parent_[i];
  }
  return {i, wraps};
}

void Surfaces::unite(std::int32_t a, std::int32_t b, int wraps_a_to_b) {
  const Rooted from_a = find(a);
  const Rooted from_b = find(b);
  if (from_a.root == from_b.root) {
    if (from_b.wraps != from_a.wraps + wraps_a_to_b) twisted_.push_back(a);
    return;
  }
  const std::int32_t roots = from_a.wraps + wraps_a_to_b - from_b.wraps;
  if (from_a.root < from_b.root) {
    parent_[from_b.root] = from_a.root;
    wraps_[from_b.root] = roots;
  } else {
    parent_[from_a.root] = from_b.root;
    wraps_[from_a.root] = -roots;
  }
}

/// The down edge that closes a block whose other three edges are joined adds nothing: most of them, inside a surface.
void Surfaces::join_edges(const ImageEdges& edges) {
  for (int r = 0; r < rows_; ++r) {
    const std::uint8_t* right = edges.right.row(r).data();
    const std::uint8_t* down = edges.down.row(r).data();
    const std::uint8_t* right_below = edges.right.row(std::min(r + 1, rows_ - 1)).data();
    std::int32_t i = r * columns_;
    bool joined_left = false;  // the pixel to the left is joined to this one, down, and below to the one below
    for (int c = 0; c < columns_; ++c, ++i) {
      const bool here = parent_[i] >= 0;
      const bool goes_right = here && (right[c] & edge::kJoined) != 0 && parent_[i + 1] >= 0;
      const bool goes_down = here && (down[c] & edge::kJoined) != 0 && parent_[i + columns_] >= 0;
      if (goes_right) unite(i, i + 1, -edge::wraps(right[c]));
      if (goes_down && !joined_left) unite(i, i + columns_, -edge::wraps(down[c]));
      joined_left = goes_right && goes_down && (right_below[c] & edge::kJoined) != 0 && parent_[i + columns_ + 1] >= 0;
    }
  }
}

/// Parents come before their children, so one sweep makes every parent a root.
void Surfaces::flatten() {
  for (std::size_t i = 0; i < parent_.size(); ++i) {
    const std::int32_t parent = parent_[i];
    if (parent < 0 || parent == static_cast<std::int32_t>(i)) continue;
    wraps_[i] += wraps_[parent];
    parent_[i] = parent_[parent];
  }
}

void Surfaces::measure() {
  size_.assign(parent_.size(), 0);
  for (const std::int32_t root : parent_)
    if (root >= 0) ++size_[root];
  for (std::int32_t& pixel : twisted_) pixel = parent_[pixel];
  std::sort(twisted_.begin(), twisted_.end());
  twisted_.erase(std::unique(twisted_.begin(), twisted_.end()), twisted_.end());
}

}  // namespace scree
