// Our Delaunay insertion against OpenCV's Subdiv2D: time, and whether the triangulation is whole.

#include "fractal/reconstruction/delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/bench/reconstruction/report.hpp"

#ifdef SCREE_BENCH_OPENCV
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#include <opencv2/imgproc.hpp>
#pragma GCC diagnostic pop
#endif

namespace scree::bench {
namespace {

using namespace fractal;

constexpr double kSide = 4096.0;

struct Cloud {
  std::vector<double> x, y;
};

/// Places a float holds exactly, so that both libraries see the same ones.
Cloud scattered_cloud(int count) {
  Cloud cloud;
  for (int i = 0; i < count; ++i) {
    const auto words = random_words(11, 1, i, 0);
    cloud.x.push_back(static_cast<double>(static_cast<float>(to_uniform(words[0]) * kSide)));
    cloud.y.push_back(static_cast<double>(static_cast<float>(to_uniform(words[1]) * kSide)));
  }
  return cloud;
}

/// A lattice in random order.
Cloud lattice_cloud(int count) {
  const int side = static_cast<int>(std::sqrt(count));
  std::vector<std::uint64_t> order;
  for (int i = 0; i < side * side; ++i)
    order.push_back(std::uint64_t{random_words(12, 1, i, 0)[0]} << 32 | static_cast<std::uint64_t>(i));
  std::sort(order.begin(), order.end());
  Cloud cloud;
  for (const std::uint64_t key : order) {
    const int i = static_cast<int>(key & 0xffffffff);
    cloud.x.push_back(1 + i % side);
    cloud.y.push_back(1 + i / side);
  }
  return cloud;
}

/// Strips of about two spacings, up and down in turn: each point near the one before.
Cloud serpentine(const Cloud& cloud) {
  const double strip = 2.0 * kSide / std::sqrt(static_cast<double>(cloud.x.size()));
  std::vector<std::array<double, 3>> order;
  for (std::size_t i = 0; i < cloud.x.size(); ++i) {
    const double k = std::floor(cloud.x[i] / strip);
    order.push_back({k, std::fmod(k, 2.0) == 0.0 ? cloud.y[i] : -cloud.y[i], cloud.x[i]});
  }
  std::sort(order.begin(), order.end());
  Cloud sorted;
  for (const auto& [k, y, x] : order) {
    sorted.x.push_back(x);
    sorted.y.push_back(std::abs(y));
  }
  return sorted;
}

struct Outcome {
  double us = 0.0;  // CPU, a point
  int triangles = 0, distinct = 0, on_hull = 0;
};

Outcome ours(const Cloud& cloud) {
  Outcome outcome;
  const Time time = timed([&] {
    const auto mesh = *Delaunay::make(cloud.x, cloud.y);
    for (int t = 0; t < mesh.triangle_count(); ++t) outcome.on_hull += mesh.is_ghost(t);
    outcome.triangles = mesh.triangle_count() - outcome.on_hull;
    outcome.distinct = mesh.vertex_count() - mesh.repeated();
  });
  outcome.us = 1e3 * time.cpu_ms / static_cast<double>(cloud.x.size());
  return outcome;
}

#ifdef SCREE_BENCH_OPENCV
Outcome opencv(const Cloud& cloud) {
  Outcome outcome;
  const Time time = timed([&] {
    cv::Subdiv2D mesh(cv::Rect(0, 0, static_cast<int>(kSide) + 1, static_cast<int>(kSide) + 1));
    for (std::size_t i = 0; i < cloud.x.size(); ++i)
      mesh.insert(cv::Point2f(static_cast<float>(cloud.x[i]), static_cast<float>(cloud.y[i])));
    std::vector<cv::Vec6f> list;
    mesh.getTriangleList(list);
    outcome.triangles = static_cast<int>(list.size());
  });
  outcome.us = 1e3 * time.cpu_ms / static_cast<double>(cloud.x.size());
  return outcome;
}
#endif

void table(const std::string& title, Cloud (*make)(int), const std::vector<int>& counts) {
  print_text("\n" + title +
             "\n\n| points | ours, µs a point | Subdiv2D, µs a point | … in strips | ours is faster by | "
             "triangles missing from Subdiv2D's |\n|---|---|---|---|---|---|");
  for (const int count : counts) {
    const Cloud cloud = make(count);
    const Outcome own = ours(cloud);
    std::string line = fmt::format("| {} | {:.2f} |", cloud.x.size(), own.us);
    if (own.triangles != 2 * own.distinct - 2 - own.on_hull) print_text("ours breaks Euler's count");
#ifdef SCREE_BENCH_OPENCV
    const Outcome sorted = opencv(serpentine(cloud));
    const bool patient = count <= 100000;  // its walk grows with √n: a million would take minutes
    const Outcome other = patient ? opencv(cloud) : Outcome{};
    const auto in_order = [&](const char* format, double value) {
      return patient ? fmt::format(fmt::runtime(format), value) : std::string("–");
    };
    line += fmt::format(" {} | {:.2f} | {}, {:.1f} | {} |", in_order("{:.2f}", other.us), sorted.us,
                        in_order("{:.0f}", other.us / own.us), sorted.us / own.us, own.triangles - sorted.triangles);
#else
    line += " not built | | | |";
#endif
    print_text(line);
  }
}

}  // namespace

void delaunay_section() {
  print_text(R"(
## Delaunay triangulation

CPU time of one thread, all points known beforehand and in random order: ours sorts them itself (rounds along a Hilbert
curve), OpenCV's Subdiv2D takes them as they come, and once more sorted along strips (sorting not counted). Ours is whole by
Euler's count in every row. Subdiv2D works in float and keeps three auxiliary points outside, whose triangles cut into
the hull.)");
  const std::vector<int> counts = quick ? std::vector{10000, 100000} : std::vector{10000, 100000, 1000000};
  table("Scattered points", scattered_cloud, counts);
  table("Points of a lattice", lattice_cloud, counts);
}

}  // namespace scree::bench
