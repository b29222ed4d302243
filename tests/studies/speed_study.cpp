// The whole chain on one core: simulated recordings replayed at full speed under `taskset -c 0`, five times each.
// Prints the table "Speed" of docs/accuracy.md.  Usage: speed_study SCREE

#include <algorithm>
#include <array>
#include <chrono>

#include "tests/studies/study.hpp"

namespace {

using namespace scree;
using namespace scree::study;

constexpr int kRuns = 5;

struct Case {
  const char* sensor;
  const char* trajectory;  ///< long enough for 40 frames
  const char* cell_m;
  double target_fps;
};
constexpr std::array<Case, 2> kCases{
    {{"perceptron-cmu", "line:-10,0,0,20,1", "0.1", 20.0}, {"depth", "line:-2,0,0,4,1", "0.05", 5.0}}};

double load_average() {
  double load = 0.0;
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

struct Run {
  double wall_s = 0.0;
  nlohmann::json node;
};

Run timed_replay(const std::string& scree, const fs::path& recording, const Case& c) {
  const auto start = std::chrono::steady_clock::now();
  const std::string out = must_run({"taskset", "-c", "0", scree, "replay", recording.string(), "--rate", "max",
                                    "--json", "--set", "publish.destination=127.0.0.1:9", "--set",
                                    "publish.listen=127.0.0.1:0", "--set", std::string("map.cell_m=") + c.cell_m});
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), nlohmann::json::parse(out)};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) fail("usage: speed_study SCREE");
  const test::TemporaryFolder folder;
  std::puts(
      "| frames | of | wall time: best, median, s | frames/s: best, median | target | map latency p50, p99, ms | load "
      "average |\n|---|---|---|---|---|---|---|");
  for (const Case& c : kCases) {
    const fs::path recording = folder / c.sensor;
    must_run({argv[1], "simulate", "--terrain", "fbm:2.3,0.1,7", "--sensor", c.sensor, "--trajectory", c.trajectory,
              "--out", recording.string()});
    std::vector<Run> runs;
    const double load = load_average();
    for (int i = 0; i < kRuns; ++i) runs.push_back(timed_replay(argv[1], recording, c));
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.wall_s < b.wall_s; });
    const Run& best = runs.front();
    const Run& median = runs[kRuns / 2];
    const double frames = best.node.at("frames_mapped");
    const auto& latency = median.node.at("latency_ms");
    std::printf("| %.0f | %s | %.2f, %.2f | %.1f, %.1f | %.0f | %.1f, %.1f | %.1f |\n", frames, c.sensor, best.wall_s,
                median.wall_s, frames / best.wall_s, frames / median.wall_s, c.target_fps,
                latency.at("p50").get<double>(), latency.at("p99").get<double>(), load);
    std::fflush(stdout);
  }
}
