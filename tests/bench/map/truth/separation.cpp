#include "tests/bench/map/truth/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace scree::bench {
namespace {

constexpr double kMostLogit = 15.0;

double sum(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0.0);
}

}  // namespace

void ScoreCounts::add(float score, bool is_impassable) {
  const int bin = static_cast<int>(std::lround(score * (kScoreBins - 1)));
  ++(is_impassable ? impassable : passable)[static_cast<std::size_t>(std::clamp(bin, 0, kScoreBins - 1))];
}

ScoreCounts& ScoreCounts::operator+=(const ScoreCounts& other) {
  for (std::size_t i = 0; i < passable.size(); ++i) {
    passable[i] += other.passable[i];
    impassable[i] += other.impassable[i];
  }
  return *this;
}

double ScoreCounts::cells() const {
  return sum(passable) + sum(impassable);
}

double ScoreCounts::share_impassable() const {
  return sum(impassable) / cells();
}

double ScoreCounts::auc() const {
  const double pairs = sum(passable) * sum(impassable);
  if (pairs == 0.0) return std::numeric_limits<double>::quiet_NaN();
  double below = 0.0, wins = 0.0;
  for (std::size_t i = 0; i < passable.size(); ++i) {
    wins += impassable[i] * (below + 0.5 * passable[i]);
    below += passable[i];
  }
  return wins / pairs;
}

Calibration isotonic(const ScoreCounts& counts) {
  struct Pool {
    double impassable, cells;
    std::size_t bins;
    double share() const { return impassable / cells; }
  };
  std::vector<Pool> pools;
  std::size_t empty = 0;  // bins without a cell go with the pool above them
  for (std::size_t i = 0; i < counts.passable.size(); ++i) {
    const double impassable = counts.impassable[i], cells = impassable + counts.passable[i];
    ++empty;
    if (cells == 0.0) continue;
    pools.push_back({impassable, cells, std::exchange(empty, 0)});
    while (pools.size() > 1 && pools[pools.size() - 2].share() >= pools.back().share()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().impassable += last.impassable;
      pools.back().cells += last.cells;
      pools.back().bins += last.bins;
    }
  }
  Calibration out;
  for (const Pool& pool : pools) {
    const double doubt = 0.5 / pool.cells;
    out.insert(out.end(), pool.bins, std::clamp(pool.share(), std::min(doubt, 0.5), 1.0 - std::min(doubt, 0.5)));
  }
  out.resize(counts.passable.size(), out.empty() ? 0.5 : out.back());
  return out;
}

float probability_score(float probability) {
  const double p = static_cast<double>(probability), odds = p / (1.0 - p);  // 0 and infinity included
  return static_cast<float>(0.5 + 0.5 * std::clamp(std::log(odds) / kMostLogit, -1.0, 1.0));
}

Calibration as_it_is() {
  Calibration out(kScoreBins);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double logit = kMostLogit * (2.0 * static_cast<double>(i) / (kScoreBins - 1) - 1.0);
    out[i] = 1.0 / (1.0 + std::exp(-logit));
  }
  return out;
}

double brier(const ScoreCounts& counts, const Calibration& calibration) {
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < calibration.size(); ++i) {
    const double p = calibration[i];
    sum_of_squares += counts.passable[i] * p * p + counts.impassable[i] * (1.0 - p) * (1.0 - p);
  }
  return sum_of_squares / counts.cells();
}

std::vector<std::array<double, 2>> roc(const ScoreCounts& counts) {
  const double passable = sum(counts.passable), impassable = sum(counts.impassable);
  std::vector<std::array<double, 2>> points = {{0.0, 0.0}};
  double alarms = 0.0, detections = 0.0;
  for (std::size_t i = counts.passable.size(); i-- > 0;) {
    if (counts.passable[i] + counts.impassable[i] == 0) continue;
    alarms += counts.passable[i];
    detections += counts.impassable[i];
    points.push_back({alarms / passable, detections / impassable});
  }
  return points;
}

}  // namespace scree::bench
