#include "drivers/frame/projection.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace scree {
namespace {

ProjectionConfig usf_in_published_units() {
  ProjectionConfig config;
  config.unit_m = 1.0;
  return config;
}

struct Golden {
  int raw, row, column;
  double x, y, z;
};
constexpr Golden kGolden[] = {
    {0, 0, 0, 75.581497, 47.210334, 143.456863},       {0, 255, 255, 0.152755, 0.105185, 168.019409},
    {0, 511, 511, -75.581497, -47.776978, 143.269144}, {1000, 0, 511, -163.573962, 104.516381, 316.439269},
    {2048, 255, 255, 0.517595, 0.364634, 582.452447},  {2048, 511, 0, 255.790064, -165.139761, 497.537111},
    {4095, 0, 0, 435.910639, 281.878594, 851.819816},  {4095, 511, 511, -435.910639, -282.445238, 851.632097},
};

// The golden numbers carry six decimals, hence 1e-6.
TEST(UsfProjection, AgreesWithGoldenValuesInDouble) {
  const auto config = complete_projection(usf_in_published_units(), 512, 512);
  ASSERT_TRUE(config);
  for (const auto& g : kGolden) {
    const PixelRay ray = pixel_ray(*config, g.row, g.column);
    const Eigen::Vector3d p = ray.origin_m + (ray.range_offset_m + g.raw * ray.range_per_count_m) * ray.direction;
    EXPECT_NEAR(p.x(), g.x, 1e-6);
    EXPECT_NEAR(p.y(), g.y, 1e-6);
    EXPECT_NEAR(p.z(), g.z, 1e-6);
    EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-15);
  }
  EXPECT_NEAR(config->ambiguity_m, 828.867, 5e-4);
}

TEST(UsfProjection, UnitScalesLengthsAndNothingElse) {
  const auto unit = complete_projection(usf_in_published_units(), 512, 512);
  const auto centimetre = complete_projection({}, 512, 512);
  ASSERT_TRUE(unit && centimetre);
  const PixelRay a = pixel_ray(*unit, 17, 400);
  const PixelRay b = pixel_ray(*centimetre, 17, 400);
  EXPECT_NEAR((a.origin_m * 0.01 - b.origin_m).norm(), 0.0, 1e-15);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_NEAR(a.range_offset_m * 0.01, b.range_offset_m, 1e-14);
  EXPECT_NEAR(centimetre->ambiguity_m, 8.28867, 5e-6);
}

// Rounding a table entry costs half an ulp (u = 2^-24) of it. range = offset + raw·delta: three roundings of terms
// bounded by the range and the offset (< 2 m), product and sum; the coordinate adds o + range·d: two more products
// and a sum of terms bounded by |o| + range. Together below 8 u · (range + |o| + 2 m).
TEST(UsfProjection, FloatTablesAgreeWithDoubleToFloatPrecision) {
  const auto tables = make_projection({}, 512, 512);
  ASSERT_TRUE(tables);
  const Projection& p = **tables;
  for (int r = 0; r < 512; r += 7)
    for (int c = 0; c < 512; c += 7)
      for (const int raw : {0, 1, 1000, 2048, 4095}) {
        const PixelRay ray = pixel_ray(p.config, r, c);
        const double range = ray.range_offset_m + raw * ray.range_per_count_m;
        const Eigen::Vector3d exact = ray.origin_m + range * ray.direction;
        const float t = p.range_offset_m(r, c) + static_cast<float>(raw) * p.range_per_count_m(r, c);
        const Eigen::Vector3f table(p.origin_x_m(r, c) + t * p.direction_x(r, c),
                                    p.origin_y_m(r, c) + t * p.direction_y(r, c),
                                    p.origin_z_m(r, c) + t * p.direction_z(r, c));
        const double bound = 8.0 * 0x1p-24 * (range + ray.origin_m.norm() + 2.0);
        ASSERT_LE((table.cast<double>() - exact).cwiseAbs().maxCoeff(), bound) << r << "," << c << " raw " << raw;
      }
}

TEST(UsfProjection, TrustsAllButTheLastFourRowsOfTheStandardSizeOnly) {
  EXPECT_EQ(complete_projection({}, 512, 512)->trusted_rows, 508);
  EXPECT_EQ(complete_projection({}, 256, 512)->trusted_rows, 256);
  ProjectionConfig all;
  all.trusted_rows = 512;
  EXPECT_EQ(complete_projection(all, 512, 512)->trusted_rows, 512);
}

TEST(CmuProjection, IsIdealPolarWithNominalConstants) {
  ProjectionConfig config;
  config.kind = ProjectionKind::perceptron_cmu;
  const auto tables = make_projection(config, 256, 256);
  ASSERT_TRUE(tables);
  EXPECT_DOUBLE_EQ((*tables)->ambiguity_m, 40.0);
  const PixelRay ray = pixel_ray((*tables)->config, 0, 255);
  const double alpha = -(std::numbers::pi / 3.0) * 127.5 / 256.0;
  const double beta = (std::numbers::pi / 3.0) * 127.5 / 256.0;
  EXPECT_EQ(ray.origin_m, Eigen::Vector3d::Zero());
  EXPECT_NEAR(ray.direction.x(), std::sin(alpha), 1e-15);
  EXPECT_NEAR(ray.direction.y(), std::cos(alpha) * std::sin(beta), 1e-15);
  EXPECT_NEAR(ray.direction.z(), std::cos(alpha) * std::cos(beta), 1e-15);
  EXPECT_DOUBLE_EQ(ray.range_offset_m, 0.0);
  EXPECT_DOUBLE_EQ(ray.range_per_count_m, 0.009765625);
}

TEST(SphericalProjection, ForwardLeftUp) {
  ProjectionConfig config;
  config.kind = ProjectionKind::spherical;
  config.range_per_count_m = 0.01;
  config.row_elevations_rad = {0.0, std::numbers::pi / 6.0};
  config.column_azimuths_rad = {0.0, std::numbers::pi / 2.0, -0.3};
  const auto complete = complete_projection(config, 2, 3);
  ASSERT_TRUE(complete);
  EXPECT_NEAR((pixel_ray(*complete, 0, 0).direction - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((pixel_ray(*complete, 0, 1).direction - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR(pixel_ray(*complete, 1, 2).direction.z(), 0.5, 1e-15);
  EXPECT_LT(pixel_ray(*complete, 1, 2).direction.y(), 0.0);
  EXPECT_EQ(complete->ambiguity_m, 0.0);
}

TEST(PinholeProjection, DepthIsTheZOfThePoint) {
  ProjectionConfig config;
  config.kind = ProjectionKind::pinhole;
  config.fx_px = 518.0;
  config.fy_px = 519.0;
  config.cx_px = 325.5;
  config.cy_px = 253.5;
  const auto complete = complete_projection(config, 480, 640);
  ASSERT_TRUE(complete);
  EXPECT_EQ(complete->invalid_raw, 0);
  for (const auto& [row, column] : {std::pair{0, 0}, {479, 639}, {100, 500}}) {
    const PixelRay ray = pixel_ray(*complete, row, column);
    const Eigen::Vector3d p = ray.origin_m + (ray.range_offset_m + 2500 * ray.range_per_count_m) * ray.direction;
    EXPECT_NEAR(p.z(), 2.5, 1e-12);
    EXPECT_NEAR(p.x(), 2.5 * (column - 325.5) / 518.0, 1e-12);
    EXPECT_NEAR(p.y(), 2.5 * (row - 253.5) / 519.0, 1e-12);
  }
}

TEST(CountAtRange, InvertsTheRangeLawAndWraps) {
  const auto config = complete_projection({}, 512, 512);
  ASSERT_TRUE(config);
  const PixelRay ray = pixel_ray(*config, 40, 77);
  for (const int raw : {0, 1, 2047, 4095}) {
    const double range = ray.range_offset_m + raw * ray.range_per_count_m;
    EXPECT_NEAR(count_at_range(ray, range), raw, 1e-9);
    for (const int k : {-1, 0, 1, 2})
      EXPECT_EQ(wrapped_count(count_at_range(ray, range + k * config->ambiguity_m)), raw);
  }
  EXPECT_EQ(wrapped_count(4095.5), 0);
  EXPECT_EQ(wrapped_count(-0.6), 4095);
}

TEST(CompleteProjection, IsIdempotent) {
  const auto once = complete_projection({}, 512, 512);
  ASSERT_TRUE(once);
  const auto twice = complete_projection(*once, 512, 512);
  ASSERT_TRUE(twice);
  EXPECT_EQ(once->trusted_rows, twice->trusted_rows);
  EXPECT_EQ(once->range_per_count_m, twice->range_per_count_m);
  EXPECT_EQ(once->ambiguity_m, twice->ambiguity_m);
  EXPECT_EQ(once->field_of_view_rad, twice->field_of_view_rad);
}

TEST(CompleteProjection, RefusesContradictionsByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = [](auto change, int rows = 512, int columns = 512) {
    ProjectionConfig config;
    change(config);
    const auto result = complete_projection(config, rows, columns);
    EXPECT_FALSE(result);
    return result ? std::string() : result.error().message;
  };
  EXPECT_NE(refusal([](auto& c) { c.rows = 256; }).find("256"), std::string::npos);
  EXPECT_NE(refusal([](auto&) {}, 0, 512).find("0 x 512"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.trusted_rows = 513; }).find("trusted_rows"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.unit_m = 0.0; }).find("unit_m"), std::string::npos);
  EXPECT_NE(refusal([&](auto& c) { c.unit_m = nan; }).find("unit_m"), std::string::npos);
  EXPECT_NE(refusal([&](auto& c) { c.range_offset_m = nan; }).find("range_offset_m"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.reflectance_shift = 8; }).find("reflectance_shift"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.field_of_view_rad[0] = 4.0; }).find("field_of_view_rad"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.kind = ProjectionKind::pinhole; }).find("fx_px"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) { c.kind = ProjectionKind::spherical; }).find("range_per_count_m"), std::string::npos);
  EXPECT_NE(refusal([](auto& c) {
              c.kind = ProjectionKind::spherical;
              c.range_per_count_m = 0.01;
            }).find("row_elevations_rad"),
            std::string::npos);
}

TEST(CloudProjection, RaysPassThroughThePoints) {
  const std::vector<Eigen::Vector3f> points{{3.0F, 4.0F, 0.0F}, {0.0F, 0.0F, -2.0F}, {0.0F, 0.0F, 0.0F}};
  const auto cloud = make_cloud_projection(points);
  ASSERT_EQ(cloud->columns, 3);
  EXPECT_FALSE(cloud->is_image());
  EXPECT_FLOAT_EQ(cloud->range_offset_m[0], 5.0F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f direction(cloud->direction_x[i], cloud->direction_y[i], cloud->direction_z[i]);
    EXPECT_LT((cloud->range_offset_m[i] * direction - points[i]).norm(), 1e-6F);
    EXPECT_NEAR(direction.norm(), 1.0F, 1e-6F);
  }
  EXPECT_EQ(make_cloud_projection({})->columns, 0);
}

TEST(ProjectionKind, NamesRoundTrip) {
  for (const auto kind : {ProjectionKind::perceptron_usf, ProjectionKind::perceptron_cmu, ProjectionKind::spherical,
                          ProjectionKind::pinhole, ProjectionKind::cloud})
    EXPECT_EQ(*parse_projection_kind(to_string(kind)), kind);
  EXPECT_FALSE(parse_projection_kind("fisheye"));
}

}  // namespace
}  // namespace scree
