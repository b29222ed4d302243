// The judges of the map's bench, against ground where the answer is known.

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/bench/map/truth/baselines.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/truth/scene_truth.hpp"
#include "tests/bench/map/truth/separation.hpp"
#include "tests/bench/map/truth/vehicle_truth.hpp"

namespace scree::bench {
namespace {

constexpr int kSide = 121;  // 3 m of nodes

template <class Height>
Grid<float> nodes(const Height& height) {
  Grid<float> z(kSide, kSide);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) z(r, c) = static_cast<float>(height(c * kNode_m, r * kNode_m));
  return z;
}

TEST(VehicleOnGround, ASlopeIsPitchAlongItAndRollAcrossIt) {
  const mapping::VehicleConfig vehicle;
  const VehicleOnGround on_ground(nodes([](double x_m, double) { return 0.3 * x_m; }), kNode_m, vehicle);
  const double angle_rad = std::atan(0.3);
  const LimitShares along = on_ground.at(1.5, 1.5, 0.0), across = on_ground.at(1.5, 1.5, 0.5 * std::numbers::pi);
  EXPECT_NEAR(along.pitch, angle_rad / vehicle.max_pitch_rad, 1e-3);
  EXPECT_NEAR(along.roll, 0.0, 1e-3);
  EXPECT_NEAR(across.roll, angle_rad / vehicle.max_roll_rad, 1e-3);
  EXPECT_NEAR(across.pitch, 0.0, 1e-3);
  EXPECT_NEAR(along.clearance, 0.0, 1e-3);
  EXPECT_NEAR(along.step, 0.3 * vehicle.wheel_radius_m / vehicle.max_step_m, 1e-3);
}

TEST(VehicleOnGround, AStoneUnderTheBellyTakesClearanceAndUnderAWheelAStep) {
  const mapping::VehicleConfig vehicle;
  const auto stone = [](double x_m, double y_m) { return std::hypot(x_m - 1.5, y_m - 1.5) < 0.06 ? 0.2 : 0.0; };
  const VehicleOnGround on_ground(nodes(stone), kNode_m, vehicle);
  const LimitShares over = on_ground.at(1.5, 1.5, 0.0);
  EXPECT_NEAR(over.clearance, 0.2 / vehicle.clearance_m, 1e-3);
  EXPECT_EQ(over.step, 0.0F);
  const LimitShares onto = on_ground.at(1.5 + 0.5 * vehicle.wheelbase_m, 1.5 + 0.5 * vehicle.track_m, 0.0);
  EXPECT_GT(onto.step, 1.0F);
  EXPECT_TRUE(std::isnan(on_ground.at(0.0, 1.5, 0.0).largest()));
}

TEST(SceneTruth, CellMeansAreThoseOfTheSurfaceAndRocksAreImpassable) {
  const Ground ground = must(make_ground({2.4, 0.02, 11}));
  const SceneTruth truth = scene_truth(ground, {}, LatticeWindow{{0, -40}, 80, 60});
  // the mean of bilinear patches is the mean of their corners
  const int row = 50, column = 60;
  double sum = 0.0;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      for (const auto& [dr, dc] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 0), std::pair(1, 1)})
        sum += static_cast<double>(ground.nodes.height_m(4 * row + r + dr, 4 * column + c + dc)) / 64.0;
  EXPECT_NEAR(truth.height_m(row, column), sum, 1e-6);
  for (const Rock& rock : ground.rocks) {
    const CellIndex cell = lattice_cell(rock.x_m, rock.y_m, kMapCell_m);
    if (rock.height_m < 0.3 || cell.x < 0 || cell.x >= 60 || std::abs(cell.y) >= 40) continue;
    EXPECT_TRUE(truth.impassable(cell.y - truth.cells.min.y, cell.x - truth.cells.min.x));
    EXPECT_EQ(truth.object_m(cell.y - truth.cells.min.y, cell.x - truth.cells.min.x), 0.0F);
  }
}

TEST(Separation, AreaUnderTheRocIsTheShareOfPairsInOrder) {
  ScoreCounts counts;
  for (const float score : {0.1F, 0.4F, 0.4F}) counts.add(score, false);
  for (const float score : {0.4F, 0.9F}) counts.add(score, true);
  EXPECT_DOUBLE_EQ(counts.auc(), (1.0 + 0.5 + 0.5 + 3.0) / 6.0);
}

TEST(Separation, IsotonicCalibrationPoolsViolators) {
  ScoreCounts counts;
  for (int i = 0; i < 10; ++i) counts.add(0.0F, i < 1);  // 0.1
  for (int i = 0; i < 10; ++i) counts.add(0.3F, i < 6);  // 0.6 and 0.4 pool to 0.5
  for (int i = 0; i < 10; ++i) counts.add(0.6F, i < 4);
  for (int i = 0; i < 10; ++i) counts.add(1.0F, i < 9);  // 0.9
  const Calibration p = isotonic(counts);
  ASSERT_EQ(p.size(), static_cast<std::size_t>(kScoreBins));
  EXPECT_DOUBLE_EQ(p.front(), 0.1);
  EXPECT_DOUBLE_EQ(p[614], 0.5);  // bin of 0.6
  EXPECT_DOUBLE_EQ(p.back(), 0.9);
  EXPECT_NEAR(brier(counts, p), (0.09 + 0.25 + 0.25 + 0.09) / 4.0, 1e-12);
}

TEST(Separation, ProbabilitiesAreTakenForWhatTheySay) {
  const Calibration p = as_it_is();
  for (const float probability : {0.0F, 1e-4F, 0.3F, 0.5F, 0.99F, 1.0F}) {
    ScoreCounts counts;
    counts.add(probability_score(probability), false);
    EXPECT_NEAR(std::sqrt(brier(counts, p)), static_cast<double>(probability), 0.004);
  }
}

TEST(Baselines, TheMembraneFillsAPlaneExactly) {
  Grid<float> z(40, 40, std::nanf(""));
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c)
      if (r < 6 || r > 30 || c < 8 || c > 33) z(r, c) = 0.02F * static_cast<float>(r) - 0.01F * static_cast<float>(c);
  const Grid<float> filled = smooth_fill(z);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c)
      EXPECT_NEAR(filled(r, c), 0.02F * static_cast<float>(r) - 0.01F * static_cast<float>(c), 2e-3F);
}

}  // namespace
}  // namespace scree::bench
