#pragma once
// One drive, judged: everything that the report says of a scene and a sensor, in sums that add up over scenes.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "mapping/snapshot.hpp"
#include "tests/bench/map/truth/baselines.hpp"
#include "tests/bench/map/truth/scene_truth.hpp"
#include "tests/bench/map/truth/separation.hpp"
#include "tests/bench/map/truth/sight.hpp"
#include "tests/bench/map/truth/welford.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {

/// What gives a cell a score. footprint: footprint_share() on the smooth fill; ceiling: on the true mean heights of the
/// cells, the most that a map of such cells can know without the law of what is inside them.
enum Method : std::uint8_t { kCost, kRisk, kRelief, kPlane, kFootprint, kCeiling };
inline constexpr int kMethods = 6;
/// Which cells are judged.
enum CellClass : std::uint8_t { kAllCells, kMeasuredCells, kReconstructedCells, kDropCells };
inline constexpr int kCellClasses = 4;
inline constexpr int kDistances = 4;  ///< to the nearest measured cell, in cells: 1, 2–3, 3–6, 6–12

/// Of heights against the mean of the ground in the cell; `far` from rocks and ditch: more than 0.3 m.
struct HeightScores {
  fractal::PredictionScore measured, measured_objects;
  std::array<fractal::PredictionScore, kDistances> open, shadow;  ///< reconstructed, see Sight
  std::array<double, kDistances> open_bias{}, shadow_bias{};      ///< sums of truth − mean
  double measured_bias = 0.0;                                     ///< likewise
  fractal::PredictionScore reconstructed_objects;
  HeightScores& operator+=(const HeightScores& other);
};

/// Of cells whose window of D holds neither rock nor ditch.
struct DimensionScores {
  std::vector<float> errors, sigmas;  ///< D less the truth; without a flag
  std::vector<float> relief_ratios;   ///< rms change over kReliefLag_m by D and amplitude, over the truth
  double flagged = 0.0;
  DimensionScores& operator+=(const DimensionScores& other);
};

/// Cells of the ditch whose mean lies more than the drop margin below the ground beside it, by state; and the cells
/// that were called a possible drop, by what they are.
struct DropScores {
  std::array<double, 5> ditch_states{};
  double drops = 0.0, drops_in_ditch = 0.0, drops_by_objects = 0.0, drops_impassable = 0.0;
  DropScores& operator+=(const DropScores& other);
};

struct Judgement {
  double dimension = 0.0, relief_m = 0.0;
  HeightScores heights;
  DimensionScores roughness;
  DropScores drops;
  std::array<std::array<ScoreCounts, kMethods>, kCellClasses> scores;
  std::array<double, 5> states{};                                      ///< cells by state
  double judged = 0.0, impassable = 0.0, impassable_everywhere = 0.0;  ///< with a cost and a truth
  /// Lethal cells whose truth is below 0.7 of every limit, and cells of such ground; within 1.5 m of the way and all.
  double false_lethal = 0.0, clear = 0.0, false_lethal_near = 0.0, clear_near = 0.0;
};

/// The rules of the baselines for one sensor.
struct BaselineRules {
  double relief_radius_m = 0.4;
  PlaneRules plane;
};

/// What a snapshot is judged against. `T_true_map` takes the map's places to where they really are (identity without
/// drift).
struct JudgeInputs {
  const GroundSpec& spec;
  const SceneTruth& truth;
  const mapping::MapSnapshot& map;
  const WelfordMap& plain;
  const BaselineRules& rules;
  const Sight* sight = nullptr;  ///< null: reconstructed cells all count as open
  Pose T_true_map;
};
Judgement judge(const JudgeInputs& in);

}  // namespace scree::bench
