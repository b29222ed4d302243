#include "mapping/roughness.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "fractal/cell_mean_law.hpp"
#include "fractal/surface.hpp"
#include "mapping/law_field.hpp"
#include "tests/support/ground_of.hpp"

namespace scree::mapping {
namespace {

constexpr int kSide = 80;

struct Scene {
  Grid<float> height_m, variance_m2 = Grid<float>(kSide, kSide, 0.0F);
  Grid<std::uint16_t> support = Grid<std::uint16_t>(kSide, kSide, 0);
  Grid<std::uint8_t> wanted = Grid<std::uint8_t>(kSide, kSide, 1);
  LatticeWindow window{{0, 0}, kSide, kSide};

  explicit Scene(Grid<float> height) : height_m(std::move(height)) {}
};

Scene rough(double dimension, std::uint64_t seed = 1) {
  return Scene(*fractal::fbm_surface({dimension, 0.1}, kSide, kSide, 0.1, seed));
}

TEST(Roughness, ReportsTheSmallWindowWhereItIsCertainEnough) {
  const Scene scene = rough(2.4);
  SerialExecutor serial;
  for (const double target : {0.0, 1.0}) {
    RoughnessConfig config;
    config.sigma_target = target;
    Roughness roughness(config);
    const RoughnessMap& map =
        roughness.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
    const auto& expected = target > 0.0 ? roughness.small() : roughness.large();
    for (int r = 20; r < 60; ++r)
      for (int c = 20; c < 60; ++c) {
        ASSERT_EQ(map.dimension(r, c), expected.dimension(r & ~1, c & ~1));  // its block's
        ASSERT_EQ(map.amplitude_m(r, c), expected.amplitude_m(r & ~1, c & ~1));
        ASSERT_EQ(map.radius_cells(r, c), target > 0.0 ? config.small_radius_cells : config.large_radius_cells);
      }
  }
}

TEST(Roughness, SaysNothingWhereNothingIsKnown) {
  Scene scene = rough(2.4);
  for (int r = 0; r < kSide; ++r)
    for (int c = 30; c < kSide; ++c) scene.height_m(r, c) = NAN;
  SerialExecutor serial;
  Roughness roughness({});
  const RoughnessMap& map =
      roughness.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  EXPECT_TRUE(std::isnan(map.dimension(40, 60)));
  EXPECT_EQ(map.radius_cells(40, 60), 0);
  EXPECT_NE(map.flags(40, 60) & fractal::kTooLittleData, 0);
}

// A changed height is heard of within two frames, wherever it is, and a cell that is not wanted has no roughness.
TEST(Roughness, IsAtMostOneFrameOld) {
  Scene scene = rough(2.4), other = rough(2.7, 2);
  SerialExecutor serial;
  Roughness followed({}), fresh({});
  scene.wanted(40, 41) = other.wanted(40, 41) = 0;
  followed.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  for (int frame = 0; frame < 2; ++frame)
    followed.update(scene.window, other.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  const RoughnessMap& a =
      followed.update(scene.window, other.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  const RoughnessMap& b =
      fresh.update(scene.window, other.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      if (r != 40 || c != 41) {
        ASSERT_EQ(a.dimension(r, c), b.dimension(r, c)) << r << ' ' << c;
      }
  EXPECT_TRUE(std::isnan(a.dimension(40, 41)));
}

TEST(LawField, FollowsTheGroundFromZoneToZoneAndKeepsToTheWindowsLawFarFromData) {
  Scene scene = rough(2.7);
  const Grid<float> smooth = *fractal::fbm_surface({2.2, 0.02}, kSide, kSide, 0.1, 2);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      if (c < 40) scene.height_m(r, c) = smooth(r, c);
      if (r >= 50) scene.height_m(r, c) = NAN;
    }
  SerialExecutor serial;
  Roughness roughness({});
  const RoughnessMap& map =
      roughness.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  LawField field(0.1);
  const fractal::FractalLaw window_law{2.45, 0.05};
  field.update(scene.window, map, window_law, test::ground_of(scene.height_m), serial);
  const fractal::LawMap& law = field.law();
  // sigma of D in a window of 21 × 21 cells is .04 at most; neighbours share most of it
  // and the law of means over cells lies where theirs does
  const auto of_cells = [](double dimension) { return 3.0F - fractal::CellMeanLaw::exact(3.0 - dimension).hurst; };
  EXPECT_NEAR(law.dimension(25, 12), of_cells(2.2), 0.16F);
  EXPECT_NEAR(law.dimension(25, 68), of_cells(2.7), 0.16F);
  EXPECT_LT(law.amplitude_m(25, 12), 0.03F);
  EXPECT_GT(law.amplitude_m(25, 68), 0.05F);
  EXPECT_GT(field.relief_m2()(25, 68), 30.0F * field.relief_m2()(25, 12));
  EXPECT_NEAR(law.dimension(78, 40), of_cells(2.45), 2e-3F);
}

TEST(LawField, StaysWithItsGroundWhenTheWindowMovesAndMovesAFifthOfTheWay) {
  const Scene scene = rough(2.5);
  SerialExecutor serial;
  Roughness roughness({});
  const RoughnessMap map =
      roughness.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  LawField field(0.1);
  field.update(scene.window, map, {2.5, 0.1}, test::ground_of(scene.height_m), serial);
  const Grid<float> before = field.law().dimension;
  // Nothing is known any more: every cell moves towards the law of the window, which is that of D 2.9.
  RoughnessMap nothing = map;
  for (float& d : nothing.dimension) d = NAN;
  LawField still(0.1);
  still.update({{3, 5}, kSide, kSide}, nothing, {2.9, 0.1}, test::ground_of(scene.height_m), serial);
  const float goal = still.law().dimension(40, 40);
  field.update({{3, 5}, kSide, kSide}, nothing, {2.9, 0.1}, test::ground_of(scene.height_m), serial);
  for (int r = 10; r < 70; ++r)
    for (int c = 10; c < 70; ++c)  // the way from D of points to D of cells is not quite straight
      ASSERT_NEAR(field.law().dimension(r, c), before(r + 5, c + 3) + 0.2F * (goal - before(r + 5, c + 3)), 0.02F);
}

// A wall 3 m high eight cells away fills the windows of D; the floor here is flat to a millimetre.
TEST(LawField, BelievesNoRoughnessBeyondWhatTheCellsAroundShow) {
  Grid<float> floor(kSide, kSide);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      floor(r, c) = (c >= 48 ? 3.0F : 0.0F) + 0.001F * static_cast<float>(r * 7919 % 13 - c * 104729 % 11);
  const Scene scene(std::move(floor));
  SerialExecutor serial;
  Roughness roughness({});
  const RoughnessMap& map =
      roughness.update(scene.window, scene.height_m, scene.variance_m2, scene.support, scene.wanted, serial);
  LawField field(0.1);
  field.update(scene.window, map, {2.5, 0.1}, test::ground_of(scene.height_m), serial);
  EXPECT_GT(map.amplitude_m(40, 40), 0.5F);
  EXPECT_LT(std::sqrt(field.relief_m2()(40, 40)), 0.02F);
}

}  // namespace
}  // namespace scree::mapping
