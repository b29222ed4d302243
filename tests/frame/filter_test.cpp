// What does not become a point: limits, the robot itself, speckle, mixed pixels; and that every pixel is counted once.

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>

#include "tests/frame/scanned_scene.hpp"

namespace scree {
namespace {

using namespace test;

const Scene kGround = plane({0, 0, 0}, {0, 0, 1});

PointFrame convert(const RangeFrame& frame) {
  SerialExecutor executor;
  PointFrame points;
  EXPECT_TRUE(PointConverter().convert(frame, {}, executor, points));
  EXPECT_EQ(accounted(points.counts), points.counts.pixels);
  EXPECT_EQ(points.size(), points.counts.points);
  return points;
}

SensorConfig looking_down(double pitch_rad) {
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, pitch_rad, 0.3);
  sensor.noise.sigma_m = 0.01;
  return sensor;
}

TEST(Limits, AreInclusiveAndCounted) {
  const auto projection = unambiguous_perceptron(64, 64);
  auto sensor = looking_down(0.7);
  sensor.filter = no_filter();
  sensor.filter.range_min_m = 2.0;
  sensor.filter.range_max_m = 3.0;
  const auto seen = scan(projection, sensor, standing(), kGround);
  std::uint64_t expected = 0;
  for (const float range : seen.frame.range_m) expected += range >= 2.0F && range <= 3.0F ? 1U : 0U;
  const auto points = convert(seen.frame);
  EXPECT_EQ(points.counts.points, expected);
  EXPECT_EQ(points.counts.out_of_limits, 64U * 64U - expected);
}

TEST(Limits, NoReturnAndUntrustedRowsAreCountedApart) {
  ProjectionConfig config;
  config.kind = ProjectionKind::perceptron_cmu;
  config.ambiguity_m = 0.0;
  config.trusted_rows = 60;
  const auto projection = *make_projection(config, 64, 64);
  auto sensor = looking_down(0.9);
  sensor.filter = no_filter();
  auto frame = scan(projection, sensor, standing(), kGround).frame;
  frame.range_m(0, 5) = std::nanf("");
  frame.range_m(1, 6) = std::numeric_limits<float>::infinity();
  frame.range_m(2, 7) = -1.0F;
  const auto counts = convert(frame).counts;
  EXPECT_EQ(counts.no_return, 2U);
  EXPECT_EQ(counts.out_of_limits, 1U);
  EXPECT_EQ(counts.untrusted_row, 4U * 64U);
  EXPECT_EQ(counts.points, 60U * 64U - 3U);
}

// A box on the robot's nose: exactly the returns inside it vanish.
TEST(SelfMask, RemovesExactlyTheBox) {
  const auto projection = unambiguous_perceptron(64, 64);
  auto sensor = looking_down(0.7);
  sensor.filter = no_filter();
  const BodyBox box{{0.8, -0.4, -0.1}, {1.8, 0.3, 0.5}};
  const Scene nose = part(plane({0, 0, 0.3}, {0, 0, 1}),
                          [](const auto& p) { return p.x() > 0.9 && p.x() < 1.7 && std::abs(p.y()) < 0.25; });
  const auto seen = scan(projection, sensor, standing(), nearest(kGround, nose));
  const auto all = convert(seen.frame);
  std::uint64_t inside = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Vector3d p = map_point(all, i);  // identity body pose
    inside += (p.array() >= box.min_m.array()).all() && (p.array() <= box.max_m.array()).all() ? 1U : 0U;
  }
  ASSERT_GT(inside, 50U);
  sensor.filter.self_mask = box;
  const auto masked = convert(scan(projection, sensor, standing(), nearest(kGround, nose)).frame);
  EXPECT_EQ(masked.counts.self, inside);
  EXPECT_EQ(masked.counts.points, 64U * 64U - inside);
}

/// `share` of all pixels become uniformly random counts; returns where.
Grid<char> scatter(Scan& seen, double share, std::uint64_t seed) {
  Grid<char> random(seen.truth_m.rows(), seen.truth_m.columns(), 0);
  const Projection& p = *seen.frame.projection;
  for (int r = 0; r < random.rows(); ++r)
    for (int c = 0; c < random.columns(); ++c) {
      const auto words = random_words(seed, 3, c, r);
      if (to_uniform(words[0]) >= share) continue;
      random(r, c) = 1;
      seen.frame.range_m(r, c) =
          p.range_offset_m(r, c) + static_cast<float>(words[1] % 4096) * p.range_per_count_m(r, c);
    }
  return random;
}

// 512 × 512 pixels of pure noise over 8.3 m: with joins of probability p ≤ 2 (0.1 + 0.03 · 10) / 8.3 ≈ 0.1, a pixel
// lies in a cluster of 12 or more with probability below 12 · t_11 p^11 / (1 − 5.14 p) ≈ 8e-4 · p-averaged far less
// (t_11 = 3 150 362 bond trees a site); without phase the whole frame keeps below 12 clusters at worst.
TEST(Speckle, PureNoiseDoesNotBecomeGround) {
  ProjectionConfig config;  // USF ranges without their ambiguity: the harder case, phase needs whole 5 × 5 blocks
  config.ambiguity_m = 0.0;
  config.trusted_rows = 512;
  const auto unambiguous = *make_projection(config, 512, 512);
  const auto ambiguous = projection_of(ProjectionKind::perceptron_usf, 512, 512);
  for (const auto& projection : {unambiguous, ambiguous}) {
    auto sensor = looking_down(0.3);
    sensor.filter.phase = PhasePolicy::first_interval;
    auto seen = scan(projection, sensor, standing(), [](const auto&, const auto&) { return std::nullopt; });
    std::uint64_t kept = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      scatter(seen, 1.1, seed);
      kept += convert(seen.frame).counts.points;
    }
    std::printf("pure noise, ambiguity %.1f m: %d of %d pixels kept\n", projection->ambiguity_m, static_cast<int>(kept),
                4 * 512 * 512);
    EXPECT_LT(kept, 4U * 200U);
  }
}

// Random sky above a horizon and random dropouts on the ground. A dropout is kept when it happens to lie within the
// join tolerance or closeness bound of its neighbours, and then errs by no more than those.
TEST(Speckle, RandomPixelsThatSurviveLieOnTheGround) {
  const auto projection = unambiguous_perceptron(256, 256);
  auto sensor = looking_down(0.3);
  auto seen = scan(projection, sensor, standing(), kGround);
  const auto random = scatter(seen, 0.05, 9);
  const auto points = convert(seen.frame);
  std::size_t far_off = 0;
  for (std::size_t i = 0; i < points.size(); ++i) far_off += std::abs(map_point(points, i).z()) > 0.25 ? 1U : 0U;
  EXPECT_GT(points.counts.speckle, 1500U);
  EXPECT_LE(far_off, 12U);
}

TEST(Speckle, KeepsAPoleOnePixelWide) {
  const auto projection = unambiguous_perceptron(128, 128);
  auto sensor = looking_down(0.2);
  auto seen = scan(projection, sensor, standing(), plane({9.0, 0, 0}, {-1, 0, 0}));
  for (int r = 10; r < 60; ++r) seen.frame.range_m(r, 64) = 4.0F;
  const auto points = convert(seen.frame);
  const auto on_pole = std::count(points.range_m.begin(), points.range_m.end(), 4.0F);
  EXPECT_GE(on_pole, 48);  // the ends have one neighbour
}

// A near wall before a far one; the pixels of the edge column hold anything in between, one or two beside each other.
TEST(MixedPixels, BetweenTwoWallsAreRejectedAndTheWallsKept) {
  const auto projection = unambiguous_perceptron(128, 128);
  auto sensor = looking_down(0.0);
  sensor.filter.speckle_min_pixels = 0;
  const Scene near = part(plane({4.0, 0, 0}, {-1, 0, 0}), [](const auto& p) { return p.y() > 0.0; });
  const auto seen = scan(projection, sensor, standing(), nearest(near, plane({8.0, 0, 0}, {-1, 0, 0})));
  const auto clean = convert(seen.frame);
  EXPECT_EQ(clean.counts.mixed, 0U);
  RangeFrame frame = seen.frame;
  int placed = 0;
  for (int r = 0; r < 128; ++r) {
    int edge = 0;  // first pixel of the far wall
    while (edge < 127 && seen.truth_m(r, edge) < 6.0F) ++edge;
    ASSERT_GT(edge, 2);
    const double u = to_uniform(random_words(4, 4, 0, r)[0]);
    const float near_m = seen.truth_m(r, edge - 1);
    const float far_m = seen.truth_m(r, edge + 1);
    frame.range_m(r, edge) = near_m + static_cast<float>(0.2 + 0.3 * u) * (far_m - near_m);
    ++placed;
    if (r % 2 == 0) continue;
    frame.range_m(r, edge + 1) = near_m + static_cast<float>(0.55 + 0.25 * u) * (far_m - near_m);
    ++placed;
  }
  const auto points = convert(frame);
  EXPECT_EQ(points.counts.mixed, static_cast<std::uint64_t>(placed));
}

TEST(MixedPixels, GrazingGroundIsNotMixed) {
  const auto projection = unambiguous_perceptron(256, 256);
  auto sensor = looking_down(0.35);
  sensor.filter.speckle_min_pixels = 0;
  for (const double noise : {0.0, 0.01}) {
    const auto points = convert(scan(projection, sensor, standing(), kGround, noise).frame);
    EXPECT_LT(points.counts.mixed, 30U) << noise;  // the last rows before the horizon may look like an edge
  }
}

/// Seven uneven ranges, last first.
class ReversedExecutor final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int i = 7; i-- > 0;)
      if (const int begin = count * i * i / 49, end = count * (i + 1) * (i + 1) / 49; begin < end) body(begin, end);
  }
};

TEST(PointConverter, ResultsDoNotDependOnTheExecutorOrOnEarlierFrames) {
  for (const auto kind : {ProjectionKind::perceptron_usf, ProjectionKind::pinhole}) {
    const auto projection = projection_of(kind, 96, 128);
    auto sensor = looking_down(0.5);
    auto seen = scan(projection, sensor, standing(), kGround, 0.01);
    scatter(seen, 0.05, 2);
    SerialExecutor serial;
    ReversedExecutor reversed;
    PointConverter warm;
    PointFrame a, b;
    ASSERT_TRUE(PointConverter().convert(seen.frame, {}, serial, a));
    auto other = scan(unambiguous_perceptron(64, 64), sensor, standing(), kGround).frame;
    ASSERT_TRUE(warm.convert(other, {}, reversed, b));
    ASSERT_TRUE(warm.convert(seen.frame, {}, reversed, b));
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.z_m, b.z_m);
    EXPECT_EQ(a.range_variance_m2, b.range_variance_m2);
    EXPECT_EQ(a.row_begin, b.row_begin);
    EXPECT_EQ(a.counts.speckle, b.counts.speckle);
    EXPECT_EQ(a.counts.ambiguous, b.counts.ambiguous);
  }
}

}  // namespace
}  // namespace scree
