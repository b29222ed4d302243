#pragma once
// Frames in, costs out: Scree's, or one of the baselines' of the report on the map.

#include <array>
#include <memory>
#include <string>

#include "client/examples/path_planner.hpp"
#include "mapping/mapper.hpp"
#include "tests/bench/map/truth/judge.hpp"

namespace scree::bench {

enum class Rival : std::uint8_t { scree, relief, plane };
inline constexpr std::array kRivals = {Rival::scree, Rival::relief, Rival::plane};
inline constexpr std::array<const char*, 3> kRivalNames = {"Scree", "smooth fill + highest − lowest",
                                                           "smooth fill + plane residuals"};

/// What the baselines are given: their rules, and what their scores say of a cell, learnt on grounds of their own.
struct BaselineTuning {
  BaselineRules rules;
  Calibration relief, plane;
};
/// Drives over grounds that the study does not use. Some minutes.
BaselineTuning tune_baselines();

class CostMaker {
 public:
  virtual ~CostMaker() = default;
  virtual void add(const RangeFrame& frame) = 0;
  /// Of the window about the robot; the cost's own unknown.
  virtual scree_example::CostGrid costs() = 0;
};
std::unique_ptr<CostMaker> make_costs(Rival rival, const BaselineTuning& tuning);

}  // namespace scree::bench
