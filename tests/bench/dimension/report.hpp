#pragma once
// What the sections of the report share: loops over surfaces on all cores, statistics of errors, Markdown.

#include <atomic>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "fractal/dimension_estimate.hpp"

namespace scree::bench {

/// A tenth of the surfaces: to see that everything runs.
inline bool quick = false;
inline int surfaces(int count) {
  return quick ? (count + 9) / 10 : count;
}

/// body(i) for i in [0, count) on all cores; results by i, so that they do not depend on the cores.
template <class Body>
auto over_surfaces(int count, const Body& body) {
  std::vector<decltype(body(0))> results(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) results[static_cast<std::size_t>(i)] = body(i);
  };
  {
    std::vector<std::jthread> others;
    for (unsigned t = 1; t < std::thread::hardware_concurrency(); ++t) others.emplace_back(work);
    work();
  }
  return results;
}

/// Of estimates of one number.
struct Errors {
  double sum = 0.0, sum2 = 0.0, worst = 0.0, covered = 0.0;
  int count = 0;
  int unknown = 0;  ///< estimates that say that the data leave D open: not in the rest

  void add(double error) {
    ++count;
    sum += error;
    sum2 += error * error;
    if (std::abs(error) > std::abs(worst)) worst = error;
  }
  void add(const fractal::DimensionEstimate& estimate, double truth) {
    if (!std::isfinite(estimate.dimension)) {
      ++unknown;
      return;
    }
    add(estimate.dimension - truth);
    covered += estimate.interval95.low <= truth && truth <= estimate.interval95.high ? 1.0 : 0.0;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(sum2 / count); }
  double sd() const { return std::sqrt(std::max(sum2 / count - mean() * mean(), 0.0)); }
  std::string unknowns() const { return unknown > 0 ? fmt::format(" ({} unknown)", unknown) : ""; }
  double coverage() const { return covered / count; }
};

inline std::string fixed(double value, int digits = 4) {
  return fmt::format("{:.{}f}", value, digits);
}
inline std::string with_sign(double value, int digits = 4) {
  return fmt::format("{:+.{}f}", value, digits);
}

/// "held", or by how much the target was missed.
inline std::string at_most(double measured, double target) {
  return measured <= target ? "held" : fmt::format("**missed** by {:.2g} %", 100.0 * (measured / target - 1.0));
}
inline std::string at_least(double measured, double target) {
  return measured >= target ? "held" : fmt::format("**missed** by {:.2g} %", 100.0 * (1.0 - measured / target));
}
inline std::string within(double measured, double low, double high) {
  if (measured >= low && measured <= high) return "held";
  return fmt::format("**missed** by {:.3f}", measured < low ? low - measured : measured - high);
}

/// A line of a table: a name and one text a column.
template <class Cell>
void print_row(const std::string& name, std::size_t columns, const Cell& cell) {
  std::string line = fmt::format("| {} |", name);
  for (std::size_t c = 0; c < columns; ++c) line += fmt::format(" {} |", std::string(cell(c)));
  std::puts(line.c_str());
  std::fflush(stdout);
}
inline void print_head(const std::string& name, std::span<const double> columns, const std::string& prefix = "D = ") {
  print_row(name, columns.size(), [&](std::size_t c) { return fmt::format("{}{:g}", prefix, columns[c]); });
  std::string line = "|---|";
  for (std::size_t c = 0; c < columns.size(); ++c) line += "---|";
  std::puts(line.c_str());
}
inline void print_text(const std::string& text) {
  std::printf("%s\n", text.c_str());
}

void scattered_section();
void small_section();
void noise_section();
void cells_section();
void paper_section();
void pairs_section();
void speed_section();

}  // namespace scree::bench
