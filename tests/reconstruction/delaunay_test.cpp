#include "fractal/reconstruction/delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

__extension__ typedef __int128 Wide;

/// Predicates on integers below 2^28 in absolute value, without any rounding: the reference.
struct Whole {
  Wide x, y;
  explicit Whole(const PlanePoint& p) : x(static_cast<std::int64_t>(p.x)), y(static_cast<std::int64_t>(p.y)) {}
};
int sign_of(Wide value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}
int whole_orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const Whole p(a), q(b), r(c);
  return sign_of((p.x - r.x) * (q.y - r.y) - (p.y - r.y) * (q.x - r.x));
}
int whole_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const Whole p(a), q(b), r(c), s(d);
  const Wide px = p.x - s.x, py = p.y - s.y, qx = q.x - s.x, qy = q.y - s.y, rx = r.x - s.x, ry = r.y - s.y;
  return sign_of((px * px + py * py) * (qx * ry - qy * rx) + (qx * qx + qy * qy) * (rx * py - ry * px) +
                 (rx * rx + ry * ry) * (px * qy - py * qx));
}

struct Points {
  std::vector<double> x, y;
  void add(double px, double py) {
    x.push_back(px);
    y.push_back(py);
  }
};

Points scattered(int count, std::uint64_t seed, double side) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const auto words = random_words(seed, 1, i, 0);
    points.add(std::floor(to_uniform(words[0]) * side), std::floor(to_uniform(words[1]) * side));
  }
  return points;
}

/// Everything that makes it a Delaunay triangulation of its distinct points, against every vertex.
void expect_delaunay(const Delaunay& mesh, int distinct) {
  EXPECT_EQ(mesh.triangle_count(), 2 * distinct - 2);  // Euler, with the ghosts and their vertex
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertex_count()), false);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Delaunay::Triangle& triangle = mesh.triangle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Delaunay::Triangle& other = mesh.triangle(triangle.neighbour[k]);
      int back = 0;
      for (std::size_t j = 0; j < 3; ++j)
        back += other.neighbour[j] == t && other.vertex[(j + 1) % 3] == triangle.vertex[(k + 2) % 3] &&
                other.vertex[(j + 2) % 3] == triangle.vertex[(k + 1) % 3];
      ASSERT_EQ(back, 1) << "triangle " << t << " edge " << k;
    }
    if (mesh.is_ghost(t)) continue;
    const PlanePoint a = mesh.point(triangle.vertex[0]), b = mesh.point(triangle.vertex[1]),
                     c = mesh.point(triangle.vertex[2]);
    ASSERT_EQ(whole_orientation(a, b, c), 1);
    for (const int v : triangle.vertex) used[static_cast<std::size_t>(v)] = true;
    for (int v = 0; v < mesh.vertex_count(); ++v) ASSERT_LE(whole_in_circle(a, b, c, mesh.point(v)), 0);
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), true), distinct);
}

TEST(Predicates, AgreeWithIntegersWhereTheAnswerIsZeroOrNearlySo) {
  int zeros = 0;
  for (int i = 0; i < 20000;
       ++i) {  // points on few lattice lines, far from the origin: half of the signs are close calls
    PlanePoint p[4];
    for (int k = 0; k < 4; ++k) {
      const auto words = random_words(3, 7, i, k);
      const double stride = i % 2 == 0 ? 1.0 : 16777259.0;
      p[k] = {(words[0] % 7) * stride + (i % 3) * 134217689.0, (words[1] % 7) * stride - 99999989.0};
    }
    if (i % 2 == 1) p[3].x += 1.0;
    EXPECT_EQ(orientation(p[0], p[1], p[2]), whole_orientation(p[0], p[1], p[2]));
    EXPECT_EQ(in_circle(p[0], p[1], p[2], p[3]), whole_in_circle(p[0], p[1], p[2], p[3]));
    zeros += in_circle(p[0], p[1], p[2], p[3]) == 0;
  }
  EXPECT_GT(zeros, 1000);
}

// The classic: 64 × 64 points one last bit apart around (0.5, 0.5) against a line far away. In units of 2^−53 all
// coordinates are integers below 2^59, their products below 2^127.
TEST(Predicates, SeeOneBitBesideALine) {
  constexpr double kUnit = 0x1p-53;
  const auto whole = [](const PlanePoint& p) {
    return std::pair{static_cast<Wide>(p.x / kUnit), static_cast<Wide>(p.y / kUnit)};
  };
  const PlanePoint q{12.0, 12.0}, r{24.0, 24.0};
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const PlanePoint p{0.5 + i * kUnit, 0.5 + j * kUnit};
      const auto [px, py] = whole(p);
      const auto [qx, qy] = whole(q);
      const auto [rx, ry] = whole(r);
      ASSERT_EQ(orientation(p, q, r), sign_of((px - rx) * (qy - ry) - (py - ry) * (qx - rx)));
      ASSERT_EQ(orientation(p, q, r), i == j ? 0 : orientation(q, r, p));
    }
}

TEST(Delaunay, CirclesOfScatteredPointsAreEmpty) {
  for (const int count : {3, 4, 10, 400}) {
    const Points points = scattered(count, 1, 1e8);
    const auto mesh = Delaunay::make(points.x, points.y);
    ASSERT_TRUE(mesh) << mesh.error().message;
    expect_delaunay(*mesh, count);
  }
}

TEST(Delaunay, TakesLatticesCirclesAndLines) {
  Points lattice, circle, line;
  for (int r = 0; r < 17; ++r)
    for (int c = 0; c < 23; ++c) lattice.add(5 * c, 5 * r);
  for (int a = -65; a <= 65; ++a)
    for (int b = -65; b <= 65; ++b)
      if (a * a + b * b == 65 * 65) circle.add(a, b);
  for (int i = 0; i < 50; ++i) line.add(7 * i, 3 * i);
  line.add(100, 1000);
  for (const Points* points : {&lattice, &circle, &line}) {
    const auto mesh = Delaunay::make(points->x, points->y);
    ASSERT_TRUE(mesh) << mesh.error().message;
    expect_delaunay(*mesh, static_cast<int>(points->x.size()));
    EXPECT_EQ(mesh->repeated(), 0);
  }
  EXPECT_EQ(circle.x.size(), 36u);  // 65 = 5·13: all of them on one circle
}

TEST(Delaunay, RepeatedPointsAreOneVertexAndAreReported) {
  const Points points = scattered(600, 2, 15);  // 225 places
  std::vector<std::vector<bool>> seen(15, std::vector<bool>(15, false));
  int distinct = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    auto place = seen[static_cast<std::size_t>(points.x[i])].begin() + static_cast<std::ptrdiff_t>(points.y[i]);
    distinct += *place ? 0 : 1;
    *place = true;
  }
  const auto mesh = Delaunay::make(points.x, points.y);
  ASSERT_TRUE(mesh) << mesh.error().message;
  expect_delaunay(*mesh, distinct);
  EXPECT_EQ(mesh->repeated(), 600 - distinct);
  for (int i = 0; i < 600; ++i) {
    EXPECT_EQ(mesh->point(mesh->vertex_of(i)), mesh->point(i));
    EXPECT_EQ(mesh->vertex_of(mesh->vertex_of(i)), mesh->vertex_of(i));
  }
}

TEST(Delaunay, GrowsInsideOutsideOnTheHullAndInLineWithIt) {
  const std::vector<double> x{0, 10, 0}, y{0, 0, 10};
  auto mesh = *Delaunay::make(x, y);
  int near = 0, distinct = 3;
  const std::vector<PlanePoint> more = {{3, 3},   {5, 0},   {20, 0},  {-10, 0},  {0, 30}, {5, 5},    {1000, 1000},
                                        {5, -70}, {0, -70}, {7, -70}, {-9, -70}, {4, 0},  {500, 500}};
  for (const PlanePoint& p : more) {
    const auto inserted = mesh.insert(p, near);
    EXPECT_TRUE(inserted.added);
    EXPECT_EQ(mesh.point(inserted.vertex), p);
    near = mesh.star()[0];
    expect_delaunay(mesh, ++distinct);
  }
  const auto again = mesh.insert({5, 5}, 0);
  EXPECT_FALSE(again.added);
  EXPECT_EQ(mesh.point(again.vertex), (PlanePoint{5, 5}));
  EXPECT_EQ(mesh.vertex_count(), distinct);
}

TEST(Delaunay, LocatesThePointsOfATriangleFromAnywhere) {
  const Points points = scattered(200, 5, 1e6);
  const auto mesh = *Delaunay::make(points.x, points.y);
  for (int i = 0; i < 500; ++i) {
    const auto words = random_words(6, 1, i, 0);
    const PlanePoint p{std::floor(to_uniform(words[0]) * 1.2e6 - 1e5), std::floor(to_uniform(words[1]) * 1.2e6 - 1e5)};
    const int found = mesh.locate(p, static_cast<int>(words[2] % static_cast<unsigned>(mesh.triangle_count())));
    int inside = 0, holds = 0;
    for (int t = 0; t < mesh.triangle_count(); ++t) {
      if (mesh.is_ghost(t)) continue;
      const auto& v = mesh.triangle(t).vertex;
      const bool in = whole_orientation(mesh.point(v[0]), mesh.point(v[1]), p) >= 0 &&
                      whole_orientation(mesh.point(v[1]), mesh.point(v[2]), p) >= 0 &&
                      whole_orientation(mesh.point(v[2]), mesh.point(v[0]), p) >= 0;
      inside += in;
      holds += in && t == found;
    }
    EXPECT_EQ(inside > 0, holds == 1);
    EXPECT_EQ(inside == 0, mesh.is_ghost(found));
  }
}

TEST(Delaunay, OrderOfThePointsDoesNotMatter) {
  const Points points = scattered(300, 8, 1e8);
  const Points backwards{{points.x.rbegin(), points.x.rend()}, {points.y.rbegin(), points.y.rend()}};
  const auto edges = [](const Delaunay& mesh, bool reversed) {
    std::vector<std::array<int, 2>> result;
    for (int t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        int a = mesh.triangle(t).vertex[k], b = mesh.triangle(t).vertex[(k + 1) % 3];
        if (a < 0 || b < 0) continue;
        if (reversed) a = 299 - a, b = 299 - b;
        if (a < b) result.push_back({a, b});
      }
    std::sort(result.begin(), result.end());
    return result;
  };
  EXPECT_EQ(edges(*Delaunay::make(points.x, points.y), false), edges(*Delaunay::make(backwards.x, backwards.y), true));
}

// Doubles that lie on a circle or on lines but for their last bits, far from the origin: exact predicates keep it whole
// (Euler) and locally Delaunay, hence Delaunay.
TEST(Delaunay, IsWholeWhereRoundingDecides) {
  Points circle, lines;
  for (int i = 0; i < 700; ++i) circle.add(1e5 + 30.0 * std::cos(0.013 * i), -2e5 + 30.0 * std::sin(0.013 * i));
  for (int i = 0; i < 300; ++i)
    for (const double slope : {0.1, 1.0 / 3.0}) lines.add(0.7 * i, slope * (0.7 * i));
  for (const Points* points : {&circle, &lines}) {
    const auto mesh = Delaunay::make(points->x, points->y);
    ASSERT_TRUE(mesh) << mesh.error().message;
    const int distinct = mesh->vertex_count() - mesh->repeated();
    EXPECT_EQ(mesh->triangle_count(), 2 * distinct - 2);
    for (int t = 0; t < mesh->triangle_count(); ++t) {
      if (mesh->is_ghost(t)) continue;
      const auto& v = mesh->triangle(t).vertex;
      ASSERT_EQ(orientation(mesh->point(v[0]), mesh->point(v[1]), mesh->point(v[2])), 1);
      for (const int other : mesh->triangle(t).neighbour)
        for (const int w : mesh->triangle(other).vertex) {
          if (w == Delaunay::kInfinite) continue;
          ASSERT_LE(in_circle(mesh->point(v[0]), mesh->point(v[1]), mesh->point(v[2]), mesh->point(w)), 0);
        }
    }
  }
}

TEST(Delaunay, SaysWhatItCannotTriangulate) {
  const auto message = [](std::vector<double> x, std::vector<double> y) {
    const auto mesh = Delaunay::make(x, y);
    EXPECT_FALSE(mesh);
    EXPECT_EQ(mesh.error().kind, ErrorKind::bad_data);
    return mesh.error().message;
  };
  EXPECT_EQ(message({0, 1}, {0, 1}), "triangulation: expected at least 3 points, found 2");
  EXPECT_EQ(message({0, 1, 2, 3}, {1, 3, 5, 7}), "triangulation: expected points off one line, found 4 on one");
  EXPECT_EQ(message({2, 2, 2}, {1, 1, 1}), "triangulation: expected points off one line, found 3 on one");
  EXPECT_EQ(message({0, 1, 2}, {0, 1}), "triangulation: expected as many x as y, found 3 and 2");
  EXPECT_EQ(message({0, 1, std::numeric_limits<double>::infinity()}, {0, 1, 0}),
            "triangulation: expected finite coordinates, found (inf, 0) at point 2");
}

}  // namespace
}  // namespace scree::fractal
