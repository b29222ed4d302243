#pragma once
// Times of calls, and what they are called on.

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/fractal/survey_scene.hpp"

namespace scree::bench {

/// Random places on a lattice fine enough to count as scattered, in random order; unit the mean spacing.
inline fractal::Survey scattered(std::size_t count, double noise = 0.0) {
  using namespace fractal;
  constexpr int kSide = 512;
  const double cell = std::sqrt(static_cast<double>(count)) / kSide;
  Survey survey = some_cells(*fbm_surface({2.4, 1.0}, kSide, kSide, cell, 1), count, cell, 1);
  add_plane(survey, 0.5, 0.0);
  add_noise(survey, noise, 0.0, 1);
  for (std::size_t i = count - 1; i > 0; --i) {
    const std::size_t other = random_words(1, 9, static_cast<std::int32_t>(i), 0)[0] % (i + 1);
    std::swap(survey.x[i], survey.x[other]);
    std::swap(survey.y[i], survey.y[other]);
    std::swap(survey.z[i], survey.z[other]);
  }
  return survey;
}

struct Time {
  double cpu_ms = 0.0, wall_ms = 0.0;
};

inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline Time timed(const std::function<void()>& call) {
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  call();
  return {1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC,
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count()};
}

/// Medians over as many rounds as fit in about two seconds of each, 31 at most; the calls take turns, so that what else
/// the machine does falls on all of them.
inline std::vector<Time> times_of(const std::vector<std::function<void()>>& calls) {
  std::vector<std::vector<double>> cpu(calls.size()), wall(calls.size());
  double total_ms = 0.0;
  do
    for (std::size_t c = 0; c < calls.size(); ++c) {
      const Time time = timed(calls[c]);
      cpu[c].push_back(time.cpu_ms);
      wall[c].push_back(time.wall_ms);
      total_ms += time.wall_ms;
    }
  while (total_ms < 2000.0 * static_cast<double>(calls.size()) && cpu[0].size() < (quick ? 3 : 31));
  std::vector<Time> times(calls.size());
  for (std::size_t c = 0; c < calls.size(); ++c) times[c] = {median(cpu[c]), median(wall[c])};
  return times;
}

void pair_speeds(std::size_t count);

}  // namespace scree::bench
