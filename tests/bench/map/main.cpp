// The measured tables of the map, as Markdown on stdout. Arguments: --quick (three dimensions, one seed), --seeds N
// (2), --soak (10,000 frames in the section on memory), --pictures FOLDER, names of sections (default: all).

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "tests/bench/map/report.hpp"

namespace {

using namespace scree::bench;

struct Section {
  std::string_view name;
  void (*print)();
};
constexpr std::array kSections = {
    Section{"ground", ground_section},         Section{"heights", heights_section},
    Section{"roughness", roughness_section},   Section{"states", states_section},
    Section{"separation", separation_section}, Section{"drift", drift_section},
    Section{"speed", speed_section},           Section{"memory", memory_section},
    Section{"pictures", pictures_section},     Section{"spread", spread_section},
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string_view> wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick")
      quick = true;
    else if (std::string_view(argv[i]) == "--soak")
      soak = true;
    else if (std::string_view(argv[i]) == "--seeds" && i + 1 < argc)
      seeds = std::max(1, std::atoi(argv[++i]));
    else if (std::string_view(argv[i]) == "--pictures" && i + 1 < argc)
      pictures = argv[++i];
    else
      wanted.emplace_back(argv[i]);
  }
  for (const auto name : wanted)
    if (std::none_of(kSections.begin(), kSections.end(), [&](const Section& s) { return s.name == name; })) {
      std::fprintf(stderr, "map_accuracy: unknown section %s\n", std::string(name).c_str());
      return 64;
    }
  if (wanted.empty())
    print_text(R"(# The map, measured

Written whole by `./dev bench-map`, section by section as `map_accuracy` prints them (`./dev bench-map NAME` for one); what the
map does and why stands in [mapping.md](mapping.md), the simulator in [simulator.md](simulator.md). Grounds and frames are
reproducible (fixed seeds); times are of the machine that ran it, ratios are what to trust.)");
  for (const Section& section : kSections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), section.name) == wanted.end()) continue;
    section.print();
    std::fprintf(stderr, "map_accuracy: %s done\n", std::string(section.name).c_str());
  }
}
