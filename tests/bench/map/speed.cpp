// Frame in → snapshot out, beside the plainest fusion of the same frames.

#include <array>
#include <chrono>
#include <thread>

#include "mapping/mapper.hpp"
#include "node/worker_pool.hpp"
#include "tests/bench/map/going.hpp"
#include "tests/bench/map/quantiles.hpp"
#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/truth/welford.hpp"

namespace scree::bench {
namespace {

struct Size {
  const char* sensor;
  const char* pixels;
};
constexpr std::array kSizes = {Size{"lidar64", "64 × 1024"}, Size{"perceptron-cmu", "256 × 256"},
                               Size{"depth", "640 × 480"}};
constexpr int kWarmUp = 24, kTimed = 120;

double milliseconds(const auto& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// What is timed, in turns on every frame.
enum Work : std::uint8_t { kWelford, kOneThread, kTwoThreads, kWide };
constexpr std::array<const char*, 4> kWorkNames = {"plain Welford (convert, mean, M2)", "whole step, 1 thread",
                                                   "whole step, 2 threads", "whole step, 400² cells, 1 thread"};
using Stages = std::array<std::vector<double>, mapping::kStages>;
struct Times {
  std::array<std::vector<double>, kWorkNames.size()> work;
  Stages one, two;
};

void note(const mapping::StageTimes& times, Stages& stages) {
  for (std::size_t s = 0; s < mapping::kStages; ++s)
    stages[s].push_back(std::chrono::duration<double, std::milli>(times.of[s]).count());
}

Times time_frames(const char* sensor) {
  EndlessDrive drive(sensor);
  SerialExecutor serial;
  node::WorkerPool pool(2);
  const std::jthread worker([&pool](const std::stop_token& stop) { pool.work(stop); });
  mapping::MapConfig config, wide_config;
  wide_config.size_cells = 400;
  WelfordFusion plain(config.cell_m, config.size_cells / 2);
  mapping::Mapper one(config, serial), two(config, pool), wide(wide_config, serial);
  Times times;
  for (int i = 0; i < kWarmUp + (quick ? 12 : kTimed); ++i) {
    const RangeFrame frame = drive.next();
    Stages untimed;
    const auto step = [&](mapping::Mapper& mapper, Stages& stages) {
      return milliseconds([&] {
        const mapping::StepReport report = must(mapper.step(frame));
        static_cast<void>(mapper.snapshot());
        if (i >= kWarmUp) note(report.stages, stages);
      });
    };
    const std::array<double, kWorkNames.size()> ms = {milliseconds([&] { plain.add(frame); }), step(one, times.one),
                                                      step(two, times.two), step(wide, untimed)};
    if (i >= kWarmUp)
      for (std::size_t w = 0; w < ms.size(); ++w) times.work[w].push_back(ms[w]);
  }
  return times;
}

/// Medians of stages do not quite add up to those of steps.
void stage_table(const Times& times, double welford_ms) {
  print_text("\n| stage | 1 thread (ms) | ratio to Welford | 2 threads (ms) |\n|---|---|---|---|");
  std::array<double, mapping::kStages> ms{};
  for (std::size_t s = 0; s < mapping::kStages; ++s) {
    ms[s] = quantile(times.one[s], 0.5);
    print_text(fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} |", mapping::kStageNames[s], ms[s], ms[s] / welford_ms,
                           quantile(times.two[s], 0.5)));
  }
  const auto of = [&](mapping::Stage stage) { return ms[static_cast<std::size_t>(stage)]; };
  using mapping::Stage;
  const double first = of(Stage::fuse) + of(Stage::look) + of(Stage::shape);
  const double second = first + of(Stage::roughness) + of(Stage::elevation);
  print_text(fmt::format(
      "\nOn one core: fusion, states, slope and step within 4 ms ({:.2f}): {}; with D, mean, sd and ceilings "
      "within 25 ms ({:.2f}): {}.",
      first, at_most(first, 4.0), second, at_most(second, 25.0)));
}

/// How many times as many steps two mappers, each on a core of its own with frames of its own, take in the time in
/// which one takes its own alone: what the machine's second core is worth to this work, and so the most that splitting
/// a step can gain.
double worth_of_second_core(const char* sensor) {
  constexpr int kFrames = 30;
  struct Lane {
    EndlessDrive drive;
    SerialExecutor serial;
    mapping::Mapper mapper{{}, serial};
    void run(int frames) {
      for (int i = 0; i < frames; ++i) must(mapper.step(drive.next()));
    }
  };
  Lane first{EndlessDrive(sensor), {}}, second{EndlessDrive(sensor), {}};
  first.run(kWarmUp);
  second.run(kWarmUp);
  std::vector<double> alone, together;
  for (int turn = 0; turn < (quick ? 1 : 5); ++turn) {
    alone.push_back(milliseconds([&] { first.run(kFrames); }));
    together.push_back(milliseconds([&] {
      const std::jthread beside([&] { second.run(kFrames); });
      first.run(kFrames);
    }));
  }
  return 2.0 * quantile(alone, 0.5) / quantile(together, 0.5);
}

}  // namespace

void speed_section() {
  print_text(fmt::format(R"(
## Speed

Wall time from the frame to the snapshot, 200 × 200 cells of 0.1 m unless said otherwise; frames of a drive forth and back
over rough ground, 0.1 m a frame, after {} frames of warm-up, {} timed; the kinds of work take turns on each frame. Ratios are
of medians, to the plain Welford fusion of the same frames.)",
                         kWarmUp, kTimed));
  for (const auto& [sensor, pixels] : kSizes) {
    print_text(
        fmt::format("\n### {} ({})\n\n| work | median (ms) | p99 (ms) | ratio |\n|---|---|---|---|", pixels, sensor));
    const Times times = time_frames(sensor);
    std::array<double, kWorkNames.size()> medians{};
    for (std::size_t w = 0; w < times.work.size(); ++w) {
      medians[w] = quantile(times.work[w], 0.5);
      print_text(fmt::format("| {} | {:.2f} | {:.2f} | {:.1f} |", kWorkNames[w], medians[w],
                             quantile(times.work[w], 0.99), medians[w] / medians[kWelford]));
    }
    stage_table(times, medians[kWelford]);
    print_text(fmt::format(
        "\nEverything within 50 ms on two cores: {}; p99 within twice the median: {}; two cores 1.6 times as "
        "fast as one ({:.2f}): {}; 400² cells within 4.5 times 200² ({:.2f}): {}.",
        at_most(medians[kTwoThreads], 50.0),
        at_most(quantile(times.work[kTwoThreads], 0.99), 2.0 * medians[kTwoThreads]),
        medians[kOneThread] / medians[kTwoThreads], at_least(medians[kOneThread] / medians[kTwoThreads], 1.6),
        medians[kWide] / medians[kOneThread], at_most(medians[kWide] / medians[kOneThread], 4.5)));
    print_text(
        fmt::format("\nTwo mappers that share nothing, one a core, take {:.2f} times as many steps as one: more than "
                    "that no step can "
                    "gain from this machine's second core.",
                    worth_of_second_core(sensor)));
  }
}

}  // namespace scree::bench
