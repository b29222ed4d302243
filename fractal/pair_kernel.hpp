#pragma once
// One point against runs of others: the inner loop of every route that looks at pairs.

#include <span>
#include <vector>

#include "fractal/annulus_rule.hpp"
#include "fractal/structure_function.hpp"

namespace scree::fractal {

/// Columns of points in the order of the loops, with kPad values behind the last that may be read and are not used.
struct PairColumns {
  static constexpr int kPad = 8;
  std::vector<float> x, y, z;
  int count = 0;

  void assign(const PointColumns& points);
  void resize(int points);
};

struct IndexRun {
  int begin = 0, end = 0;
};

/// Sums over pairs: float32 in eight private histograms, moved to double every few thousand pairs. Not shared between
/// threads; no allocation after construction.
class PairAccumulator {
 public:
  explicit PairAccumulator(const Annuli& annuli);

  /// Pairs of point i with the points of the runs (i not among them).
  void add(const PairColumns& points, int i, std::span<const IndexRun> runs);
  /// Sums an annulus, so far.
  const std::vector<PairSums>& sums();
  std::size_t pairs() const { return pairs_; }

 private:
  void add_run(const PairColumns& points, int i, IndexRun run);
  void scatter();
  void flush();

  AnnulusRule rule_;
  Annuli::Spacing spacing_;
  std::vector<PairSums> sums_;
  std::vector<float> lanes_;  ///< lane, annulus, {count, |dz|, dz², ln d}
  std::vector<std::int32_t> keys_;
  std::vector<float> values_;  ///< pair, {1, |dz|, dz², ln d}
  int buffered_ = 0;
  int unflushed_ = 0;
  std::size_t pairs_ = 0;
};

}  // namespace scree::fractal
