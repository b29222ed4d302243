// Times of the routes to the structure function, as ratios to the loop that a careful person writes first, compiled
// with the same flags.

#include <array>

#include "core/executor.hpp"
#include "node/worker_pool.hpp"
#include "tests/bench/dimension/timing.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

/// Root and round each pair, counters A, B and C, in double.
std::vector<PairSums> naive(const Survey& survey, int last_lag) {
  std::vector<PairSums> sums(static_cast<std::size_t>(last_lag) + 1);
  for (std::size_t i = 0; i < survey.z.size(); ++i)
    for (std::size_t j = i + 1; j < survey.z.size(); ++j) {
      const double dx = survey.x[j] - survey.x[i], dy = survey.y[j] - survey.y[i];
      const int lag = static_cast<int>(std::sqrt(dx * dx + dy * dy) + 0.5);
      if (lag < 1 || lag > last_lag) continue;
      const double dz = survey.z[j] - survey.z[i];
      auto& sum = sums[static_cast<std::size_t>(lag)];
      sum.count += 1.0;
      sum.abs_m += std::abs(dz);
      sum.square_m2 += dz * dz;
    }
  return sums;
}

/// Two threads that say how long the busier one was busy: what the wall would show if both cores were free.
class TwoThreads final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    std::array<double, 2> busy_ms{};
    {
      const auto work = [&](std::size_t t, int begin, int end) {
        const double start_ms = thread_ms();
        body(begin, end);
        busy_ms[t] = thread_ms() - start_ms;
      };
      const std::jthread other([&] { work(1, count / 2, count); });
      work(0, 0, count / 2);
    }
    busier_ms += std::max(busy_ms[0], busy_ms[1]);
  }
  double busier_ms = 0.0;

 private:
  static double thread_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }
};

/// One thread's CPU time over that of the busier of two: median of three.
double balance(const std::function<void(Executor&)>& call) {
  std::vector<double> gains;
  for (int i = 0; i < 3; ++i) {
    SerialExecutor serial;
    TwoThreads two;
    const Time alone = timed([&] { call(serial); });
    call(two);
    gains.push_back(alone.cpu_ms / two.busier_ms);
  }
  return median(gains);
}

struct Route {
  const char* name;
  PairOptions options;
  bool geometric;
  double target;  // times the naive loop; 0: none
};

constexpr PairOptions kThin1{.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 1.0},
    kThin2{.route = PairRoute::thinned, .spacing_m = 1.0},
    kThin4{.route = PairRoute::thinned, .spacing_m = 1.0, .thinning_density = 4.0},
    kLattice{.route = PairRoute::lattice, .spacing_m = 1.0}, kHalf{.route = PairRoute::lattice, .spacing_m = 0.5};

}  // namespace

void pair_speeds(std::size_t count) {
  const Survey survey = scattered(count);
  const PointColumns points = survey.columns();
  const int last_lag = static_cast<int>(std::sqrt(static_cast<double>(count)) / 4.0);
  const Annuli uniform = uniform_annuli(1.0, last_lag), geometric = geometric_annuli(1.0, std::sqrt(2.0), last_lag);
  const bool large = count > 20000;
  std::vector<PairSums> check;
  const Time base = times_of({[&] { check = naive(survey, last_lag); }})[0];
  print_text(
      fmt::format("\n| N = {}, lags 1 … {} | CPU ms | wall ms | naive CPU / CPU | target | |\n|---|---|---|---|---|---|"
                  "\n| naive loop | {:.1f} | {:.1f} | 1 | | |",
                  count, last_lag, base.cpu_ms, base.wall_ms));
  const auto print = [&](const std::string& name, const Time& time, double target) {
    const double ratio = base.cpu_ms / time.cpu_ms;
    print_text(fmt::format("| {} | {:.2f} | {:.2f} | {:.{}f} | {} | {} |", name, time.cpu_ms, time.wall_ms, ratio,
                           ratio < 100.0 ? 1 : 0, target > 0.0 ? fmt::format("{:g}", target) : "",
                           target > 0.0 ? at_least(ratio, target) : ""));
    std::fflush(stdout);
  };
  const auto call = [&](const Annuli& annuli, const PairOptions& options, Executor& executor) {
    if (!structure_function(points, annuli, options, executor)) std::exit(70);
  };
  SerialExecutor serial;
  node::WorkerPool pool(2);
  const std::jthread worker([&](const std::stop_token& stop) { pool.work(stop); });
  const PairOptions all{.route = PairRoute::all_pairs};
  const auto exact = times_of({[&] { call(uniform, all, serial); }, [&] { call(uniform, all, pool); }});
  print("all pairs, vectorised", exact[0], 2.5);
  const double wall_gain = exact[0].wall_ms / exact[1].wall_ms;
  print_text(fmt::format("| same, two threads, by the wall | {:.2f} | {:.2f} | {:.2f} × one thread | 1.7 × | {} |",
                         exact[1].cpu_ms, exact[1].wall_ms, wall_gain, at_least(wall_gain, 1.7)));
  const double gain = balance([&](Executor& executor) { call(uniform, all, executor); });
  print_text(fmt::format("| same, by the CPU time of the busier thread | | | {:.2f} × one thread | 1.7 × | {} |", gain,
                         at_least(gain, 1.7)));
  for (const Route& route :
       {Route{"near pairs (cell list)", {}, false, 14.0},
        Route{"thinned, density 2 (default)", kThin2, false, large ? 800.0 : 200.0},
        Route{"thinned, density 2, geometric annuli", kThin2, true, large ? 800.0 : 200.0},
        Route{"thinned, density 1", kThin1, false, 0.0}, Route{"thinned, density 4", kThin4, false, 0.0},
        Route{"lattice (FFT), cell 1 spacing", kLattice, false, large ? 1000.0 : 0.0},
        Route{"lattice (FFT), cell ½ spacing", kHalf, false, 0.0}})
    print(route.name, times_of({[&] { call(route.geometric ? geometric : uniform, route.options, serial); }})[0],
          route.target);
}

}  // namespace scree::bench
