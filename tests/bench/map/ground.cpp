// The grounds themselves: which share of them the vehicle cannot stand on, and why.

#include <numbers>

#include "tests/bench/map/campaign.hpp"
#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/truth/vehicle_truth.hpp"

namespace scree::bench {
namespace {

/// Shares of places: impassable at the worst heading, at every one; by limit at a random heading.
struct GroundShares {
  double worst = 0.0, every = 0.0, pitch = 0.0, roll = 0.0, clearance = 0.0, step = 0.0;
};

GroundShares shares_of(const GroundSpec& spec) {
  constexpr int kStride = 12, kRim = 40;
  const Ground ground = must(make_ground(spec));
  const Grid<float>& nodes = ground.nodes.height_m;
  const VehicleOnGround vehicle(nodes, kNode_m, {});
  GroundShares sum;
  double places = 0.0;
  for (int row = kRim; row < nodes.rows() - kRim; row += kStride)
    for (int column = kRim; column < nodes.columns() - kRim; column += kStride, places += 1.0) {
      int violated = 0;
      LimitShares some;
      for (int k = 0; k < kTruthHeadings; ++k) {
        const LimitShares at = vehicle.at(column * kNode_m, row * kNode_m, std::numbers::pi * k / kTruthHeadings);
        violated += at.largest() > 1.0F ? 1 : 0;
        if (k == (row + column) / kStride % kTruthHeadings) some = at;
      }
      sum.worst += violated > 0 ? 1.0 : 0.0, sum.every += violated == kTruthHeadings ? 1.0 : 0.0;
      sum.pitch += some.pitch > 1.0F ? 1.0 : 0.0, sum.roll += some.roll > 1.0F ? 1.0 : 0.0;
      sum.clearance += some.clearance > 1.0F ? 1.0 : 0.0, sum.step += some.step > 1.0F ? 1.0 : 0.0;
    }
  for (double* share : {&sum.worst, &sum.every, &sum.pitch, &sum.roll, &sum.clearance, &sum.step}) *share /= places;
  return sum;
}

}  // namespace

void ground_section() {
  print_text(R"(
## The grounds

Exact fBm on nodes of 25 mm, with 18 rocks (upper halves of ellipsoids, radius 0.1–0.4 m, height 0.1–0.5 m) and a winding ditch
(0.5–0.8 m wide, 0.5 m deep) ahead of the robot, which drives 7 m towards it, a frame every 0.6 s. Two amplitudes, told by the
rms height change over 0.3 m: with one change over 1 m for every D, smooth ground would stop the vehicle nowhere and rough
ground everywhere.

The truth of a cell: the default vehicle's footprint centred on it, at 16 headings over half a turn. A wheel rests on the mean
of the ground in a square of 0.1 m; pitch and roll are those of the plane through the four contacts; the belly is the rectangle
between them, against every node; a step is the largest change of contact height within a wheel radius of a wheel. Impassable:
some limit is violated at the worst heading. Shares of all places, one surface a line:

| D | change over 0.3 m | amplitude (1 m) | impassable | at every heading | one heading: pitch | roll | clearance | step |
|---|---|---|---|---|---|---|---|---|)");
  std::vector<GroundSpec> specs;
  for (const double d : kDimensions)
    for (const double relief_m : kReliefs_m) specs.push_back({d, relief_m, kTuningSeed + specs.size()});
  const auto shares = over_surfaces(static_cast<int>(quick ? 2 : specs.size()),
                                    [&](int i) { return shares_of(specs[static_cast<std::size_t>(i)]); });
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const GroundShares& s = shares[i];
    const double amplitude_m = specs[i].relief_m * std::pow(1.0 / kReliefLag_m, 3.0 - specs[i].dimension);
    print_text(fmt::format(
        "| {:.1f} | {:.2f} m | {:.3f} m | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % |",
        specs[i].dimension, specs[i].relief_m, amplitude_m, 100 * s.worst, 100 * s.every, 100 * s.pitch, 100 * s.roll,
        100 * s.clearance, 100 * s.step));
  }
}

}  // namespace scree::bench
