// What the map says of cells beside heights: states, possible drops, false alarms.

#include "tests/bench/map/bootstrap.hpp"
#include "tests/bench/map/campaign.hpp"

namespace scree::bench {
namespace {

std::string percent(double part, double whole, int digits = 1) {
  return whole > 0.0 ? fmt::format("{:.{}f} %", 100.0 * part / whole, digits) : "—";
}

void states_table() {
  print_text(
      "\n| sensor | never seen | occluded | possible drop | reconstructed | measured | lethal, but clear | of those "
      "near "
      "the way |\n|---|---|---|---|---|---|---|---|");
  for (const SensorResults& r : campaign()) {
    std::array<double, 5> states{};
    double all = 0.0, false_lethal = 0.0, clear = 0.0, false_near = 0.0, clear_near = 0.0;
    for (const Judgement& j : r.scenes) {
      for (std::size_t s = 0; s < states.size(); ++s) states[s] += j.states[s], all += j.states[s];
      false_lethal += j.false_lethal, clear += j.clear;
      false_near += j.false_lethal_near, clear_near += j.clear_near;
    }
    print_text(fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |", r.sensor, percent(states[0], all),
                           percent(states[1], all), percent(states[2], all), percent(states[3], all),
                           percent(states[4], all), percent(false_lethal, clear, 2),
                           percent(false_near, clear_near, 2)));
  }
}

void drops_table() {
  print_text(R"(
| sensor | low cells of the ditch | possible drop | measured | reconstructed | occluded | never seen | possible drops | in the ditch | by rocks and its rim | impassable |
|---|---|---|---|---|---|---|---|---|---|---|)");
  for (const SensorResults& r : campaign()) {
    const DropScores s = total(scenes_of(r.scenes), &Judgement::drops);
    double low = 0.0;
    for (const double cells : s.ditch_states) low += cells;
    print_text(fmt::format("| {} | {:.0f} | {} | {} | {} | {} | {} | {:.0f} | {} | {} | {} |", r.sensor, low,
                           percent(s.ditch_states[2], low), percent(s.ditch_states[4], low),
                           percent(s.ditch_states[3], low), percent(s.ditch_states[1], low),
                           percent(s.ditch_states[0], low), s.drops, percent(s.drops_in_ditch, s.drops),
                           percent(s.drops_by_objects, s.drops), percent(s.drops_impassable, s.drops)));
  }
}

}  // namespace

void states_section() {
  print_text(R"(
## Cell states

Shares of the window's cells. *Lethal, but clear*: cells with cost 254 among cells whose true ground takes less than 0.7 of
every limit at every heading; near the way: within 1.5 m of it.)");
  states_table();
  print_text(R"(
**Possible drops.** Recall: what became of the cells of the ditch that lie more than 0.2 m below the highest ground within
0.6 m. Precision: where the possible drops are, and how many of them the vehicle cannot stand on.)");
  drops_table();
}

}  // namespace scree::bench
