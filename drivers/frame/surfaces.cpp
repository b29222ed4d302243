#include "drivers/frame/surfaces.hpp"

namespace scree {

void Surfaces::label(const Grid<PixelState>& state, const ImageEdges& edges, Joining joining) {
  rows_ = state.rows();
  columns_ = state.columns();
  parent_.resize(state.size());
  wraps_.assign(state.size(), 0);
  for (std::size_t i = 0; i < state.size(); ++i)
    parent_[i] = state[i] == PixelState::kept ? static_cast<std::int32_t>(i) : -1;
  if (joining == Joining::edges) {
    join_edges(edges);
  } else {
    join_quads(edges, edge::kJoined | edge::kTight);
    if (joining == Joining::quads) join_quads(edges, edge::kJoined);
  }
  flatten();
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
  if (from_a.root == from_b.root) return;  // a wrap that disagrees is overruled by the tighter edges joined before it
  const std::int32_t roots = from_a.wraps + wraps_a_to_b - from_b.wraps;
  if (from_a.root < from_b.root) {
    parent_[from_b.root] = from_a.root;
    wraps_[from_b.root] = roots;
  } else {
    parent_[from_a.root] = from_b.root;
    wraps_[from_a.root] = -roots;
  }
}

void Surfaces::join_edges(const ImageEdges& edges) {
  for (int r = 0; r < rows_; ++r) {
    const std::uint8_t* right = edges.right.row(r).data();
    const std::uint8_t* down = edges.down.row(r).data();
    std::int32_t i = r * columns_;
    for (int c = 0; c < columns_; ++c, ++i) {
      if (parent_[i] < 0) continue;
      if ((right[c] & edge::kJoined) != 0 && parent_[i + 1] >= 0) unite(i, i + 1, -edge::wraps(right[c]));
      if ((down[c] & edge::kJoined) != 0 && parent_[i + columns_] >= 0) unite(i, i + columns_, -edge::wraps(down[c]));
    }
  }
}

void Surfaces::join_quads(const ImageEdges& edges, std::uint8_t needed) {
  for (int r = 0; r + 1 < rows_; ++r) {
    const std::uint8_t* top = edges.right.row(r).data();
    const std::uint8_t* bottom = edges.right.row(r + 1).data();
    const std::uint8_t* side = edges.down.row(r).data();
    std::int32_t i = r * columns_;
    for (int c = 0; c + 1 < columns_; ++c, ++i) {
      if ((top[c] & bottom[c] & side[c] & side[c + 1] & needed) != needed) continue;
      const std::int32_t below = i + columns_;
      if (parent_[i] < 0 || parent_[i + 1] < 0 || parent_[below] < 0 || parent_[below + 1] < 0) continue;
      const int across = edge::wraps(top[c]);
      const int across_below = edge::wraps(bottom[c]);
      const int down_left = edge::wraps(side[c]);
      if (across + edge::wraps(side[c + 1]) != down_left + across_below) continue;
      unite(i, i + 1, -across);  // a range that grows by an interval along the edge means one interval fewer there
      unite(i, below, -down_left);
      unite(below, below + 1, -across_below);
    }
  }
}

/// Parents come before their children, so one sweep makes every parent a root.
void Surfaces::flatten() {
  size_.assign(parent_.size(), 0);
  for (std::size_t i = 0; i < parent_.size(); ++i) {
    const std::int32_t parent = parent_[i];
    if (parent < 0) continue;
    if (parent != static_cast<std::int32_t>(i)) {
      wraps_[i] += wraps_[parent];
      parent_[i] = parent_[parent];
    }
    ++size_[parent_[i]];
  }
}

}  // namespace scree
