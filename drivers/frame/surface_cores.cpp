// The joining of ambiguous ranges. Across an occluding edge the ranges may happen to differ by an interval along a
// short stretch; a surface must not continue through such a neck. So surfaces continue only through cores: pixels in
// whose 5 × 5 neighbourhood all 16 quads are whole, which no neck shorter than five pixels has.

#include "drivers/frame/surfaces.hpp"

namespace scree {

void Surfaces::find_quads(const ImageEdges& edges, std::uint8_t needed) {
  quad_.assign(rows_, columns_, 0);
  for (int r = 0; r + 1 < rows_; ++r) {
    const std::uint8_t* top = edges.right.row(r).data();
    const std::uint8_t* bottom = edges.right.row(r + 1).data();
    const std::uint8_t* side = edges.down.row(r).data();
    const std::int32_t* here = parent_.data() + static_cast<std::ptrdiff_t>(r) * columns_;
    const std::int32_t* below = here + columns_;
    std::uint8_t* quad = quad_.row(r).data();
    for (int c = 0; c + 1 < columns_; ++c) {
      const int joined = static_cast<int>((top[c] & bottom[c] & side[c] & side[c + 1] & needed) == needed);
      const int kept = static_cast<int>((here[c] | here[c + 1] | below[c] | below[c + 1]) >= 0);
      const int around = edge::wraps(top[c]) + edge::wraps(side[c + 1]) - edge::wraps(side[c]) - edge::wraps(bottom[c]);
      quad[c] = static_cast<std::uint8_t>(joined & kept & static_cast<int>(around == 0));
    }
  }
}

/// Erosion by rows, then by columns. Pixels nearer than two to the border cannot be cores.
void Surfaces::find_cores() {
  row_of_quads_.assign(rows_, columns_, 0);
  core_.assign(rows_, columns_, 0);
  for (int r = 0; r < rows_; ++r) {
    const std::uint8_t* quad = quad_.row(r).data();
    std::uint8_t* out = row_of_quads_.row(r).data();
    for (int c = 2; c + 2 < columns_; ++c)
      out[c] = static_cast<std::uint8_t>(quad[c - 2] & quad[c - 1] & quad[c] & quad[c + 1]);
  }
  for (int r = 2; r + 2 < rows_; ++r) {
    const std::uint8_t* a = row_of_quads_.row(r - 2).data();
    const std::uint8_t* b = row_of_quads_.row(r - 1).data();
    const std::uint8_t* c = row_of_quads_.row(r).data();
    const std::uint8_t* d = row_of_quads_.row(r + 1).data();
    std::uint8_t* out = core_.row(r).data();
    for (int i = 0; i < columns_; ++i) out[i] = static_cast<std::uint8_t>(a[i] & b[i] & c[i] & d[i]);
  }
}

/// Neighbouring cores are joined: the edge between them belongs to whole quads. The down edge beside another one adds
/// nothing, since the wraps cancel around the quad between them.
void Surfaces::join_cores(const ImageEdges& edges) {
  for (int r = 2; r + 2 < rows_; ++r) {
    const std::uint8_t* core = core_.row(r).data();
    const std::uint8_t* below = core_.row(r + 1).data();
    const std::uint8_t* right = edges.right.row(r).data();
    const std::uint8_t* down = edges.down.row(r).data();
    std::int32_t i = r * columns_;
    for (int c = 0; c + 1 < columns_; ++c, ++i) {
      if (core[c] == 0) continue;  // a range that grows by an interval along an edge means one interval fewer there
      if (core[c + 1] != 0) unite(i, i + 1, -edge::wraps(right[c]));
      const bool beside_another = c > 0 && (core[c - 1] & below[c - 1]) != 0;
      if (below[c] != 0 && !beside_another) unite(i, i + columns_, -edge::wraps(down[c]));
    }
  }
}

/// The surface that a pixel outside the cores adjoins through whole quads; false when none, or when they disagree.
bool Surfaces::attach(const ImageEdges& edges, int row, int column, Rooted& to) const {
  int found = 0;
  bool agree = true;
  const auto offer = [&](int r, int c, int wraps_from_there) {
    if (core_(r, c) == 0) return;
    const auto there = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
    const Rooted candidate{parent_[there], wraps_[there] + wraps_from_there};
    if (found++ == 0) to = candidate;
    agree = agree && candidate.root == to.root && candidate.wraps == to.wraps;
  };
  const auto quad = [&](int r, int c) { return r >= 0 && c >= 0 && quad_(r, c) != 0; };
  const bool above_left = quad(row - 1, column - 1);
  const bool above_right = quad(row - 1, column);
  const bool below_left = quad(row, column - 1);
  const bool below_right = quad(row, column);
  if (above_left || above_right) offer(row - 1, column, -edge::wraps(edges.down(row - 1, column)));
  if (below_left || below_right) offer(row + 1, column, edge::wraps(edges.down(row, column)));
  if (above_left || below_left) offer(row, column - 1, -edge::wraps(edges.right(row, column - 1)));
  if (above_right || below_right) offer(row, column + 1, edge::wraps(edges.right(row, column)));
  return found > 0 && agree;
}

/// Up to four steps along the image's axes (the corner of a 5 × 5 neighbourhood), each decided before it is attached:
/// between two surfaces a pixel goes to the nearer one, and to none when they are equally near.
void Surfaces::grow(const ImageEdges& edges) {
  for (int step = 0; step < 4; ++step) {
    attachments_.clear();
    std::int32_t i = 0;
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c, ++i) {
        Rooted to{};
        if (core_[static_cast<std::size_t>(i)] == 0 && parent_[i] >= 0 && attach(edges, r, c, to))
          attachments_.push_back({i, to});
      }
    for (const Attachment& attachment : attachments_) {
      core_[static_cast<std::size_t>(attachment.pixel)] = 1;
      parent_[attachment.pixel] = attachment.to.root;
      wraps_[attachment.pixel] = attachment.to.wraps;
    }
  }
}

}  // namespace scree
