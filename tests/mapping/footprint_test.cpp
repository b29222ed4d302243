#include "mapping/footprint.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace scree::mapping {
namespace {

constexpr double kCell_m = 0.1;

double height_m(const Footprint::Part& part, double gx, double gy) {
  return gx * part.offset.x * kCell_m + gy * part.offset.y * kCell_m;
}

TEST(Footprint, PlanesHaveTheirTiltAtEveryHeadingAndVehicle) {
  for (const VehicleConfig& vehicle : {VehicleConfig{}, VehicleConfig{1.1, 1.7, 0.3, 0.2, 0.4, 0.4, 0.2, 2.0}}) {
    const int headings = 8;
    const auto all = footprints(vehicle, kCell_m, headings);
    ASSERT_EQ(all.size(), 8U);
    for (int k = 0; k < headings; ++k) {
      const double heading = (k + 0.5) * std::numbers::pi / headings, gx = 0.2, gy = -0.35;
      const Footprint& footprint = all[static_cast<std::size_t>(k)];
      double level = 0.0, along = 0.0, across = 0.0;
      for (std::size_t w = 0; w < footprint.wheels.size(); ++w) {
        const double z = height_m(footprint.wheels[w], gx, gy);
        level += static_cast<double>(footprint.level[w]) * z;
        along += static_cast<double>(footprint.along[w]) * z;
        across += static_cast<double>(footprint.across[w]) * z;
      }
      EXPECT_NEAR(level, 0.0, 1e-6);
      EXPECT_NEAR(along, gx * std::cos(heading) + gy * std::sin(heading), 1e-6) << k;
      EXPECT_NEAR(across, gy * std::cos(heading) - gx * std::sin(heading), 1e-6) << k;
    }
  }
}

TEST(Footprint, WheelsStandWithinHalfACellOfTheirPlaces) {
  const VehicleConfig vehicle;
  for (const Footprint& footprint : footprints(vehicle, kCell_m, 8))
    for (const Footprint::Part& wheel : footprint.wheels) {
      // half a diagonal of a cell from (±wheelbase/2, ±track/2)
      EXPECT_LE(std::hypot(std::abs(wheel.along_m) - 0.3F, std::abs(wheel.across_m) - 0.25F), 0.0708F);
    }
}

TEST(Footprint, TheBellyIsBetweenTheWheels) {
  for (const Footprint& footprint : footprints({}, kCell_m, 8)) {
    // 0.6 m × 0.5 m of cells of 0.01 m², less the wheels', give or take the border
    EXPECT_GE(footprint.belly.size(), 20U);
    EXPECT_LE(footprint.belly.size(), 42U);
    for (const Footprint::Part& part : footprint.belly) {
      EXPECT_LE(std::abs(part.along_m), 0.3F + 1e-6F);
      EXPECT_LE(std::abs(part.across_m), 0.25F + 1e-6F);
    }
  }
}

TEST(Footprint, AVehicleSmallerThanACellHasNoTilt) {
  VehicleConfig toy;
  toy.track_m = toy.wheelbase_m = 0.01;
  for (const Footprint& footprint : footprints(toy, kCell_m, 4)) {
    EXPECT_TRUE(footprint.belly.empty());
    for (const float weight : footprint.along) EXPECT_NEAR(weight, 0.0F, 1e-6F);
  }
}

}  // namespace
}  // namespace scree::mapping
