#include "drivers/terrain.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "core/random.hpp"

namespace scree::drivers {
namespace {

using Eigen::Vector3d;
using Kind = TerrainHit::Kind;

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr double kFar_m = 1000.0;

/// Nodes at (i − half) · cell for both axes, so that node coordinates are exact for cells that are powers of two.
Terrain make_terrain(int half, double cell_m, const std::function<double(double x, double y)>& height) {
  io::Raster raster;
  raster.cell_m = raster.cell_y_m = cell_m;
  raster.x_min_m = raster.y_min_m = -(half + 0.5) * cell_m;
  raster.height_m.assign(2 * half + 1, 2 * half + 1, 0.0F);
  for (int r = 0; r <= 2 * half; ++r)
    for (int c = 0; c <= 2 * half; ++c)
      raster.height_m(r, c) = static_cast<float>(height((c - half) * cell_m, (r - half) * cell_m));
  auto terrain = Terrain::make(std::move(raster), "test");
  EXPECT_TRUE(terrain);
  return *std::move(terrain);
}

double uniform(std::uint64_t stream, int i, double low, double high) {
  return low + (high - low) * to_uniform(random_words(11, stream, i, 0)[0]);
}

TEST(Terrain, HeightIsBilinearBetweenTheCellCentres) {
  const auto terrain = make_terrain(4, 0.5, [](double x, double y) { return x * y; });
  for (const auto& [x, y] : {std::pair{0.3, 0.7}, {-1.9, 1.2}, {2.0, -2.0}, {0.0, 0.0}})
    EXPECT_NEAR(terrain.height_m(x, y), x * y, 1e-14);
  EXPECT_TRUE(std::isnan(terrain.height_m(2.01, 0.0)));
  EXPECT_TRUE(std::isnan(terrain.height_m(0.0, -2.01)));
}

TEST(TerrainCast, TiltedPlaneIsMetWhereAnalysisSays) {
  // Slopes and node coordinates are binary fractions: the surface is the plane exactly.
  const auto terrain = make_terrain(64, 0.25, [](double x, double y) { return 0.25 * x - 0.125 * y + 1.0; });
  const Vector3d normal = Vector3d(-0.25, 0.125, 1.0).normalized();
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin(uniform(1, i, -15, 15), uniform(2, i, -15, 15), 8.0);
    const Vector3d target(uniform(3, i, -15, 15), uniform(4, i, -15, 15), 0.0);
    const Vector3d on_plane(target.x(), target.y(), 0.25 * target.x() - 0.125 * target.y() + 1.0);
    const Vector3d ray = (on_plane - origin).normalized();
    const auto hit = terrain.cast(origin, ray, kFar_m);
    ASSERT_EQ(hit.kind, Kind::surface) << i;
    EXPECT_NEAR(hit.distance_m, (on_plane - origin).norm(), 1e-11);
    EXPECT_NEAR((hit.normal - normal).norm(), 0.0, 1e-12);
  }
}

TEST(TerrainCast, HyperbolicParaboloidIsMetAtTheRootOfItsQuadratic) {
  const auto terrain = make_terrain(32, 0.25, [](double x, double y) { return 0.125 * x * y; });
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin(uniform(5, i, -7, 7), uniform(6, i, -7, 7), 9.0);
    const Vector3d end(uniform(7, i, -7, 7), uniform(8, i, -7, 7), uniform(9, i, -9, 0));
    const Vector3d ray = (end - origin).normalized();
    // origin.z + t·z = ⅛ (origin.x + t·x)(origin.y + t·y), smallest positive root
    const double a = -0.125 * ray.x() * ray.y();
    const double b = ray.z() - 0.125 * (origin.x() * ray.y() + origin.y() * ray.x());
    const double c = origin.z() - 0.125 * origin.x() * origin.y();
    const double t = std::abs(a) < 1e-9 ? -c / b : 2.0 * c / (-b + std::sqrt(b * b - 4.0 * a * c));
    const Vector3d meeting = origin + t * ray;
    if (!(t > 0.0) || std::abs(meeting.x()) > 7.9 || std::abs(meeting.y()) > 7.9) continue;
    const auto hit = terrain.cast(origin, ray, kFar_m);
    ASSERT_EQ(hit.kind, Kind::surface) << i;
    EXPECT_NEAR(hit.distance_m, t, 1e-9) << i;
  }
}

TEST(TerrainCast, SphereCapIsMetToTheErrorOfItsPatches) {
  // Cap of radius 4 m, patches of 2^-6 m: vertical interpolation error ≤ cell²/8 · (|z_xx| + |z_yy|) with |z''| <
  // 0.36/m for the part within 1.5 m of the axis; a vertical ray sees that error, float nodes add 2.4e-7.
  const double radius = 4.0, cell = 1.0 / 64.0;
  const auto terrain =
      make_terrain(96, cell, [&](double x, double y) { return std::sqrt(radius * radius - x * x - y * y); });
  const double bound = cell * cell / 8.0 * 2.0 * 0.36 + 2.4e-7;
  for (int i = 0; i < 1000; ++i) {
    const double x = uniform(12, i, -1.0, 1.0), y = uniform(13, i, -1.0, 1.0);
    const auto hit = terrain.cast({x, y, 10.0}, -Vector3d::UnitZ(), kFar_m);
    ASSERT_EQ(hit.kind, Kind::surface);
    EXPECT_NEAR(10.0 - hit.distance_m, std::sqrt(radius * radius - x * x - y * y), bound);
  }
}

TEST(TerrainCast, StepIsMetOnItsRiser) {
  // Nodes x ≤ 0 at 0 m, x ≥ 0.5 at 1 m: the riser is the plane z = 2x.
  const auto terrain = make_terrain(16, 0.5, [](double x, double) { return x > 0.25 ? 1.0 : 0.0; });
  const auto riser = terrain.cast({-4.0, 0.1, 0.5}, Vector3d::UnitX(), kFar_m);
  ASSERT_EQ(riser.kind, Kind::surface);
  EXPECT_NEAR(riser.distance_m, 4.25, 1e-12);
  EXPECT_NEAR((riser.normal - Vector3d(-2.0, 0.0, 1.0).normalized()).norm(), 0.0, 1e-12);
  EXPECT_EQ(terrain.cast({-4.0, 0.1, 1.5}, Vector3d::UnitX(), kFar_m).kind, Kind::nothing);
  EXPECT_EQ(terrain.cast({-4.0, 0.1, 0.5}, Vector3d::UnitX(), 4.2).kind, Kind::nothing);
}

TEST(TerrainCast, RayThroughAHoleIsBeneathAndNeverASurface) {
  // A hole of 3 × 3 patches around the origin of a level plane.
  const auto terrain = make_terrain(16, 0.5, [](double x, double y) {
    return std::abs(x) < 0.6 && std::abs(y) < 0.6 ? static_cast<double>(kHole) : 0.0;
  });
  EXPECT_TRUE(std::isnan(terrain.height_m(0.9, 0.0)));
  EXPECT_EQ(terrain.cast({-4.0, 0.0, 2.0}, Vector3d(4.0, 0.0, -2.0), kFar_m).kind, Kind::beneath);
  EXPECT_EQ(terrain.cast({0.0, 0.0, 2.0}, -Vector3d::UnitZ(), kFar_m).kind, Kind::nothing);
  EXPECT_EQ(terrain.cast({-4.0, 0.0, 2.0}, Vector3d(2.9, 0.0, -2.0), kFar_m).kind, Kind::surface);
  // Over the hole and onto the far side.
  EXPECT_EQ(terrain.cast({-4.0, 0.0, 2.0}, Vector3d(5.1, 0.0, -2.0), kFar_m).kind, Kind::surface);
  // From under the surface upwards, and from outside below the rim.
  EXPECT_EQ(terrain.cast({4.0, 0.0, -1.0}, Vector3d(0.0, 0.0, 1.0), kFar_m).kind, Kind::beneath);
  EXPECT_EQ(terrain.cast({-20.0, 0.0, -1.0}, Vector3d(1.0, 0.0, 0.01), kFar_m).kind, Kind::beneath);
}

/// Brute force that shares nothing with the walk: the ray against height_m in steps of a hundredth of a cell.
struct Profile {
  bool starts_beneath_known = false;  ///< some sample lies under the surface
  double first_beneath_m = 0.0;
};
Profile march(const Terrain& terrain, const Vector3d& origin, const Vector3d& ray, double length_m, double step_m) {
  for (double t = 0.0; t <= length_m; t += step_m) {
    const Vector3d p = origin + t * ray;
    if (p.z() < terrain.height_m(p.x(), p.y()) - 1e-7) return {true, t};
  }
  return {};
}

TEST(TerrainCast, RoughTerrainWithHolesAgreesWithMarching) {
  const double cell = 0.25, step = cell / 100.0;
  const auto terrain = make_terrain(20, cell, [&](double x, double y) {
    const auto w = random_words(3, 0, static_cast<int>(std::lround(x / cell)), static_cast<int>(std::lround(y / cell)));
    return to_uniform(w[1]) < 0.02 ? static_cast<double>(kHole) : 0.6 * to_uniform(w[0]);
  });
  int surfaces = 0, beneaths = 0, nothings = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d origin(uniform(21, i, -6, 6), uniform(22, i, -6, 6), uniform(23, i, 0.7, 2.0));
    const Vector3d ray = Vector3d(uniform(24, i, -1, 1), uniform(25, i, -1, 1),
                                  i % 3 == 0 ? -uniform(26, i, 0, 0.2) : -uniform(26, i, 0, 2))
                             .normalized();
    const double length = 14.0;
    const auto hit = terrain.cast(origin, ray, length);
    if (hit.kind == Kind::surface) {
      ++surfaces;
      const Vector3d p = origin + hit.distance_m * ray;
      EXPECT_NEAR(p.z(), terrain.height_m(p.x(), p.y()), 1e-9) << i;
      // Marching finds the ground no sooner; it may find it later where the ray only skims a crest.
      const auto profile = march(terrain, origin, ray, hit.distance_m - 1e-6, step);
      EXPECT_FALSE(profile.starts_beneath_known) << i;
    } else if (hit.kind == Kind::beneath) {
      ++beneaths;
      const auto profile = march(terrain, origin, ray, length, step);
      ASSERT_TRUE(profile.starts_beneath_known) << i;
      EXPECT_GE(profile.first_beneath_m, hit.distance_m - 1e-6) << i;
      // Just before it entered the patch there was no surface under it.
      const Vector3d before = origin + (hit.distance_m - 1e-6) * ray;
      EXPECT_TRUE(std::isnan(terrain.height_m(before.x(), before.y()))) << i;
    } else {
      ++nothings;
      EXPECT_FALSE(march(terrain, origin, ray, length, step).starts_beneath_known) << i;
    }
  }
  EXPECT_GT(surfaces, 1000);  // each kind is well covered
  EXPECT_GT(beneaths, 50);
  EXPECT_GT(nothings, 20);
}

TEST(TerrainCast, OblongCellsAndAnyDirectionLengthGiveTheSamePlace) {
  io::Raster raster;
  raster.cell_m = 0.5;
  raster.cell_y_m = 0.125;
  raster.x_min_m = -0.25;
  raster.y_min_m = -0.0625;
  raster.height_m.assign(33, 9, 0.0F);
  for (int r = 0; r < 33; ++r)
    for (int c = 0; c < 9; ++c) raster.height_m(r, c) = static_cast<float>(0.5 * c * 0.5 - 0.25 * r * 0.125);
  const auto terrain = Terrain::make(raster, "oblong");
  ASSERT_TRUE(terrain);
  EXPECT_EQ(terrain->x_max_m(), 4.0);
  EXPECT_EQ(terrain->y_max_m(), 4.0);
  const Vector3d origin(0.3, 0.2, 5.0), target(3.3, 2.9, 0.5 * 3.3 - 0.25 * 2.9);
  EXPECT_NEAR(terrain->cast(origin, target - origin, 10.0).distance_m, 1.0, 1e-12);
  EXPECT_NEAR(terrain->cast(origin, (target - origin) / 7.0, 10.0).distance_m, 7.0, 1e-12);
}

TEST(Terrain, RefusesWhatIsNoSurface) {
  const auto kind_and_text = [](io::Raster raster) {
    const auto terrain = Terrain::make(std::move(raster), "patch.tif");
    EXPECT_FALSE(terrain);
    return terrain ? Error{} : terrain.error();
  };
  io::Raster degrees{Grid<float>(4, 4, 1.0F)};
  degrees.geographic = true;
  EXPECT_NE(kind_and_text(degrees).message.find("degrees"), std::string::npos);
  EXPECT_EQ(kind_and_text(degrees).kind, ErrorKind::bad_data);
  EXPECT_NE(kind_and_text({Grid<float>(1, 4, 1.0F)}).message.find("2 × 2"), std::string::npos);
  EXPECT_NE(kind_and_text({Grid<float>(4, 4, kHole)}).message.find("holes everywhere"), std::string::npos);
  io::Raster flat{Grid<float>(4, 4, 1.0F)};
  flat.cell_m = 0.0;
  EXPECT_NE(kind_and_text(flat).message.find("patch.tif"), std::string::npos);
}

}  // namespace
}  // namespace scree::drivers
