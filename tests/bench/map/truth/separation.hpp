#pragma once
// How well a score tells impassable cells from passable ones.

#include <array>
#include <cstdint>
#include <vector>

namespace scree::bench {

inline constexpr int kScoreBins = 1024;

/// Counts of passable and impassable cells by score: all that rank statistics and calibration need, and what they need
/// for sums over any set of scenes.
struct ScoreCounts {
  std::vector<std::uint32_t> passable = std::vector<std::uint32_t>(kScoreBins, 0), impassable = passable;

  /// `score` in 0 … 1, larger = worse ground.
  void add(float score, bool is_impassable);
  ScoreCounts& operator+=(const ScoreCounts& other);
  double cells() const;
  double share_impassable() const;
  /// Probability that an impassable cell has a larger score than a passable one, ties counting half: the area under
  /// the ROC. NaN when one kind is missing.
  double auc() const;
};

/// Probability of impassable for each bin.
using Calibration = std::vector<double>;

/// The maximum-likelihood one that never falls with the score (pool adjacent violators), then held within
/// ½/cells … 1 − ½/cells of its pools: no pool of a finite sample is certain.
Calibration isotonic(const ScoreCounts& counts);
/// A probability as a score that keeps apart what is almost certain: its logit from −15 … 15 to 0 … 1.
float probability_score(float probability);
/// The calibration that takes such scores for what they say.
Calibration as_it_is();

/// Mean squared difference of probability and truth [B50].
double brier(const ScoreCounts& counts, const Calibration& calibration);

/// Points (false alarms, detections) from (0, 0) to (1, 1), one a bin.
std::vector<std::array<double, 2>> roc(const ScoreCounts& counts);

}  // namespace scree::bench
