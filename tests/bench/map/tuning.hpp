#pragma once
// The best that the baselines can do: their windows, critical values and weights chosen on grounds of their own.

#include <memory>
#include <vector>

#include "tests/bench/map/truth/judge.hpp"

namespace scree::bench {

/// A driven map that rules may be tried on.
struct TuningMap {
  GroundSpec spec;
  std::shared_ptr<const SceneTruth> truth;
  std::shared_ptr<const mapping::MapSnapshot> map;
  WelfordMap plain;
};

/// The rules with the largest area under the ROC over the cells of all `maps` together that have a cost: the relief's
/// radius by trying all, the plane's rules coordinate by coordinate from the published ones, twice round.
BaselineRules tuned_rules(const std::vector<TuningMap>& maps);

}  // namespace scree::bench
