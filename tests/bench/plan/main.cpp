// The closed loop, measured, as Markdown on stdout. Arguments: --quick (two seeds), --seeds N (20).

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/plan/closed_loop.hpp"

namespace {

using namespace scree::bench;

constexpr std::array kDimensions = {2.2, 2.4, 2.6};
constexpr double kRelief_m = 0.05;
constexpr std::uint64_t kFirstSeed = 1000;

/// One world, by every rival.
struct World {
  double dimension = 0.0;
  std::array<Outcome, kRivals.size()> by;
};

double mean(const std::vector<const World*>& worlds, std::size_t rival, double (*of)(const Outcome&)) {
  double sum = 0.0, n = 0.0;
  for (const World* world : worlds)
    if (const double value = of(world->by[rival]); !std::isnan(value)) {
      sum += value;
      n += 1.0;
    }
  return sum / n;
}

double arrived(const Outcome& o) {
  return o.arrived ? 1.0 : 0.0;
}
double unharmed(const Outcome& o) {
  return o.arrived && o.violated_m == 0.0 ? 1.0 : 0.0;
}
double path_m(const Outcome& o) {
  return o.arrived ? o.path_m : std::nan("");
}
double violated_share(const Outcome& o) {
  return o.path_m > 0.0 ? o.violated_m / o.path_m : 0.0;
}

void print_dimension(const std::vector<World>& all, double dimension) {
  std::vector<const World*> worlds;
  for (const World& world : all)
    if (world.dimension == dimension) worlds.push_back(&world);
  for (std::size_t rival = 0; rival < kRivals.size(); ++rival) {
    const auto of = [&](double (*value)(const Outcome&), int digits) {
      return interval_text(bootstrap(worlds, [&](const auto& drawn) { return mean(drawn, rival, value); }), digits);
    };
    print_text(fmt::format("| {} | {} | {} | {} | {} | {} |", dimension, kRivalNames[rival], of(arrived, 2),
                           of(unharmed, 2), of(path_m, 1), of(violated_share, 3)));
  }
}

/// World by world, so that a hard one is hard for both.
void print_pairs(const std::vector<World>& worlds) {
  for (std::size_t rival = 1; rival < kRivals.size(); ++rival) {
    int ours_alone = 0, theirs_alone = 0, both = 0, less = 0, more = 0;
    double longer_m = 0.0;
    for (const World& world : worlds) {
      const Outcome &ours = world.by[0], &theirs = world.by[rival];
      ours_alone += unharmed(ours) > unharmed(theirs) ? 1 : 0;
      theirs_alone += unharmed(ours) < unharmed(theirs) ? 1 : 0;
      if (!ours.arrived || !theirs.arrived) continue;
      ++both;
      longer_m += ours.path_m - theirs.path_m;
      less += ours.violated_m < theirs.violated_m ? 1 : 0;
      more += ours.violated_m > theirs.violated_m ? 1 : 0;
    }
    print_text(fmt::format(
        "Against {}: of {} worlds {} were crossed unharmed by Scree's costs alone, {} by theirs alone. Where both "
        "arrived "
        "({}), ours were less far beyond a limit in {} and farther in {}; our ways were {:+.2f} m longer on average.",
        kRivalNames[rival], worlds.size(), ours_alone, theirs_alone, both, less, more, longer_m / std::max(both, 1)));
  }
  std::uint64_t unjudged = 0;
  for (const World& world : worlds)
    for (const Outcome& o : world.by) unjudged += o.unjudged;
  print_text(fmt::format("Poses that could not be judged, for want of ground under the footprint: {}.", unjudged));
}

}  // namespace

int main(int argc, char** argv) {
  int seeds = 20;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick") {
      quick = true;
      seeds = 2;
    } else if (std::string_view(argv[i]) == "--seeds" && i + 1 < argc) {
      seeds = std::max(1, std::atoi(argv[++i]));
    } else {
      std::fprintf(stderr, "plan_accuracy: expected --quick or --seeds N, found %s\n", argv[i]);
      return 64;
    }
  }
  print_text(fmt::format(R"(# The closed loop, measured

Written whole by `./dev bench-plan`: {} seeds × D 2.2, 2.4, 2.6. Each world is exact fBm ground with an rms height change of
{} m over 0.3 m, 18 half-buried rocks and a ditch ([map-accuracy.md](map-accuracy.md) has the ground); the robot (default
vehicle, exact poses, 64-row lidar with nominal noise every {} s) is to go from (−4.5, −4.5) to (4.5, 4.5), 12.7 m as the crow
flies, within 90 s. The planner is `client/examples/path_planner.hpp` with its default rules, the same for all; it plans again for every
map. The costs are Scree's as they are sent; or the baselines' of the report on the map, their rules tuned and their scores
calibrated to probabilities of impassable ground on other grounds of the same kinds, cost 252·p, lethal from p = 0.8. All
is judged on the true ground (`node/ground_limits.hpp`): *beyond a limit* is where the plane under the wheels, a step
within a wheel's radius of one, or the ground under the belly exceeds a limit of the vehicle; the first {} m, which the lidar cannot see from the start, count for
nobody. In brackets: 95 % over worlds.

| D | costs | arrived | arrived, never beyond a limit | path (m) of those that arrived | share of the way beyond a limit |
|---|---|---|---|---|---|)",
                         seeds, kRelief_m, kFrame_s, kBlind_m));
  const BaselineTuning tuning = tune_baselines();
  std::fprintf(stderr, "plan_accuracy: baselines tuned\n");
  const int count = static_cast<int>(kDimensions.size()) * seeds;
  const auto worlds = over_surfaces(count, [&](int i) {
    World world;
    world.dimension = kDimensions[static_cast<std::size_t>(i / seeds)];
    Mission mission;
    mission.spec = {world.dimension, kRelief_m, kFirstSeed + static_cast<std::uint64_t>(i % seeds)};
    const GroundFile ground(must(make_ground(mission.spec)));
    for (std::size_t rival = 0; rival < kRivals.size(); ++rival)
      world.by[rival] = drive(mission, ground, kRivals[rival], tuning);
    return world;
  });
  for (const double dimension : kDimensions) print_dimension(worlds, dimension);
  print_text("");
  print_pairs(worlds);
}
