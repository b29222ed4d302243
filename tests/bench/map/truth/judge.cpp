#include "tests/bench/map/truth/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree::bench {
namespace {

constexpr float kObject_m = 0.3F;  // from a rock or the ditch: the ground's own
constexpr float kClearShare = 0.7F;
constexpr double kNear_m = 1.5;
constexpr float kDropMargin_m = 0.2F;
constexpr double kDimensionWindow_m = 1.25;  // radius of the window of D, a cell of its increments, half a cell
constexpr std::array<double, kDistances> kDistanceEnds = {1.0, 3.0, 6.0, 12.0};

/// Of each cell to the nearest measured one, in cells.
Grid<float> measured_distances(const Grid<CellState>& state) {
  Grid<float> known(state.rows(), state.columns(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state[i] == CellState::measured) known[i] = 0.0F;
  return fractal::distance_to_data(known);
}

/// One cell with its truth.
struct Place {
  int row, column;              // of the map
  int truth_row, truth_column;  // of the truth
  double x_m, y_m;              // true
};

class Judge {
 public:
  explicit Judge(const JudgeInputs& in)
      : in_(in), state_(in.map.state), measured_distance_(measured_distances(state_)) {
    out_.dimension = in.spec.dimension;
    out_.relief_m = in.spec.relief_m;
    const Grid<float> filled = smooth_fill(in.plain.mean_m);
    relief_ = relief_score(relief(filled, kMapCell_m, in.rules.relief_radius_m));
    plane_ = plane_hazard(filled, kMapCell_m, in.rules.plane);
    footprint_ = footprint_share(filled, kMapCell_m, {});
  }

  Judgement run() {
    for (int row = 0; row < state_.rows(); ++row)
      for (int column = 0; column < state_.columns(); ++column) {
        const Place place = place_of(row, column);
        if (!in_.truth.height_m.contains(place.truth_row, place.truth_column)) continue;
        ++out_.states[static_cast<std::size_t>(state_(row, column))];
        height(place);
        roughness(place);
        drop(place);
        separation(place);
      }
    return std::move(out_);
  }

 private:
  Place place_of(int row, int column) const {
    const mapping::MapSnapshot& map = in_.map;
    const float z_m = map.elevation_m(row, column);
    const Eigen::Vector3d p((map.window.min.x + column + 0.5) * kMapCell_m, (map.window.min.y + row + 0.5) * kMapCell_m,
                            std::isnan(z_m) ? 0.0 : static_cast<double>(z_m));
    const Eigen::Vector3d q = in_.T_true_map * p;
    const CellIndex cell = lattice_cell(q.x(), q.y(), kMapCell_m);
    return {row, column, cell.y - in_.truth.cells.min.y, cell.x - in_.truth.cells.min.x, q.x(), q.y()};
  }
  float true_height_m(const Place& p) const { return in_.truth.height_m(p.truth_row, p.truth_column); }
  float object_m(const Place& p) const { return in_.truth.object_m(p.truth_row, p.truth_column); }

  void height(const Place& p) {
    const CellState state = state_(p.row, p.column);
    const Grid<float>& means = in_.map.elevation_mean_m.empty() ? in_.map.elevation_m : in_.map.elevation_mean_m;
    const double sd = static_cast<double>(in_.map.elevation_sigma_m(p.row, p.column));
    const double error = static_cast<double>(true_height_m(p) - means(p.row, p.column));
    if (!(sd > 0.0) || !std::isfinite(error)) return;
    HeightScores& h = out_.heights;
    const bool by_object = object_m(p) <= kObject_m;
    if (state == CellState::measured) (by_object ? h.measured_objects : h.measured).add(error, sd);
    if (state == CellState::measured && !by_object) h.measured_bias += error;
    if (state != CellState::reconstructed) return;
    if (by_object) return h.reconstructed_objects.add(error, sd);
    const auto distance = static_cast<double>(measured_distance_(p.row, p.column));
    const auto end = std::find_if(kDistanceEnds.begin(), kDistanceEnds.end(), [&](double e) { return distance <= e; });
    if (end == kDistanceEnds.end()) return;
    const auto bin = static_cast<std::size_t>(end - kDistanceEnds.begin());
    const Eigen::Vector3d point(p.x_m, p.y_m, static_cast<double>(true_height_m(p)));
    const bool open = in_.sight == nullptr || in_.sight->open(point);
    (open ? h.open : h.shadow)[bin].add(error, sd);
    (open ? h.open_bias : h.shadow_bias)[bin] += error;
  }

  void roughness(const Place& p) {
    const mapping::MapSnapshot& map = in_.map;
    const float d = map.dimension(p.row, p.column), amplitude_m = map.amplitude_m(p.row, p.column);
    if (!std::isfinite(d) || static_cast<double>(object_m(p)) <= kDimensionWindow_m) return;
    if (map.dimension_flags(p.row, p.column) != 0) {
      out_.roughness.flagged += 1.0;
      return;
    }
    out_.roughness.errors.push_back(d - static_cast<float>(in_.spec.dimension));
    out_.roughness.sigmas.push_back(map.dimension_sigma(p.row, p.column));
    const fractal::FractalLaw law{static_cast<double>(d), static_cast<double>(amplitude_m)};
    out_.roughness.relief_ratios.push_back(static_cast<float>(law.rms_change_m(kReliefLag_m) / in_.spec.relief_m));
  }

  /// Ground beside the ditch: the highest true cell within 0.6 m.
  float beside_m(const Place& p) const {
    constexpr int kReach = 6;
    float best = -std::numeric_limits<float>::infinity();
    for (int r = p.truth_row - kReach; r <= p.truth_row + kReach; ++r)
      for (int c = p.truth_column - kReach; c <= p.truth_column + kReach; ++c)
        if (in_.truth.height_m.contains(r, c)) best = std::max(best, in_.truth.height_m(r, c));
    return best;
  }

  void drop(const Place& p) {
    const CellState state = state_(p.row, p.column);
    const bool ditch = in_.truth.ditch(p.truth_row, p.truth_column) != 0;
    if (ditch && true_height_m(p) < beside_m(p) - kDropMargin_m)
      ++out_.drops.ditch_states[static_cast<std::size_t>(state)];
    if (state != CellState::possible_drop) return;
    ++out_.drops.drops;
    if (ditch)
      ++out_.drops.drops_in_ditch;
    else if (object_m(p) <= kObject_m)
      ++out_.drops.drops_by_objects;
    if (in_.truth.impassable(p.truth_row, p.truth_column)) ++out_.drops.drops_impassable;
  }

  void separation(const Place& p) {
    const std::uint8_t cost = in_.map.cost(p.row, p.column);
    const float share = in_.truth.worst_share(p.truth_row, p.truth_column);
    const float relief = relief_(p.row, p.column), footprint = footprint_(p.row, p.column);
    if (cost == mapping::kCostUnknown || std::isnan(share + relief + plane_(p.row, p.column) + footprint)) return;
    const float ceiling = in_.truth.cell_share(p.truth_row, p.truth_column);
    const bool impassable = share > 1.0F;
    count_false_lethal(p, cost, share);
    out_.judged += 1.0;
    out_.impassable += impassable ? 1.0 : 0.0;
    out_.impassable_everywhere += in_.truth.impassable_everywhere(p.truth_row, p.truth_column) ? 1.0 : 0.0;
    const std::array<float, kMethods> score = {static_cast<float>(cost) / mapping::kCostLethal,
                                               risk(p),
                                               relief,
                                               plane_(p.row, p.column),
                                               footprint / (footprint + 1.0F),
                                               ceiling / (ceiling + 1.0F)};
    const CellState state = state_(p.row, p.column);
    const int kind = state == CellState::measured        ? kMeasuredCells
                     : state == CellState::reconstructed ? kReconstructedCells
                                                         : kDropCells;
    for (std::size_t m = 0; m < score.size(); ++m) {
      if (std::isnan(score[m])) continue;
      out_.scores[kAllCells][m].add(score[m], impassable);
      out_.scores[static_cast<std::size_t>(kind)][m].add(score[m], impassable);
    }
  }

  /// A possible drop has no draws to judge: it counts as certain, as its cost does.
  float risk(const Place& p) const {
    if (in_.map.risk.empty()) return std::numeric_limits<float>::quiet_NaN();
    const float risk = in_.map.risk(p.row, p.column);
    return probability_score(std::isnan(risk) && state_(p.row, p.column) == CellState::possible_drop ? 1.0F : risk);
  }

  void count_false_lethal(const Place& p, std::uint8_t cost, float share) {
    if (share >= kClearShare) return;
    const bool near = std::abs(p.y_m) < kNear_m && p.x_m > -3.5 - kNear_m && p.x_m < 3.5 + kNear_m;
    const double lethal = cost == mapping::kCostLethal ? 1.0 : 0.0;
    out_.clear += 1.0;
    out_.false_lethal += lethal;
    if (!near) return;
    out_.clear_near += 1.0;
    out_.false_lethal_near += lethal;
  }

  const JudgeInputs& in_;
  const Grid<CellState>& state_;
  Grid<float> measured_distance_;
  Grid<float> relief_, plane_, footprint_;
  Judgement out_;
};

}  // namespace

Judgement judge(const JudgeInputs& in) {
  return Judge(in).run();
}

HeightScores& HeightScores::operator+=(const HeightScores& other) {
  measured += other.measured, measured_objects += other.measured_objects;
  measured_bias += other.measured_bias;
  reconstructed_objects += other.reconstructed_objects;
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] += other.open[i], shadow[i] += other.shadow[i];
    open_bias[i] += other.open_bias[i], shadow_bias[i] += other.shadow_bias[i];
  }
  return *this;
}

DimensionScores& DimensionScores::operator+=(const DimensionScores& other) {
  errors.insert(errors.end(), other.errors.begin(), other.errors.end());
  sigmas.insert(sigmas.end(), other.sigmas.begin(), other.sigmas.end());
  relief_ratios.insert(relief_ratios.end(), other.relief_ratios.begin(), other.relief_ratios.end());
  flagged += other.flagged;
  return *this;
}

DropScores& DropScores::operator+=(const DropScores& other) {
  for (std::size_t i = 0; i < ditch_states.size(); ++i) ditch_states[i] += other.ditch_states[i];
  drops += other.drops, drops_in_ditch += other.drops_in_ditch;
  drops_by_objects += other.drops_by_objects, drops_impassable += other.drops_impassable;
  return *this;
}

}  // namespace scree::bench
