// The measured tables of docs/dimension-accuracy.md, as Markdown on stdout: `./dev bench-dimension`. Arguments: --quick
// (a tenth of the surfaces), names of sections (default: all).

#include <array>
#include <fstream>
#include <string_view>

#include "tests/bench/dimension/report.hpp"

namespace {

using namespace scree::bench;

struct Section {
  std::string_view name;
  void (*print)();
};
constexpr std::array<Section, 7> kSections = {{{"scattered", scattered_section},
                                               {"small", small_section},
                                               {"noise", noise_section},
                                               {"cells", cells_section},
                                               {"paper", paper_section},
                                               {"pairs", pairs_section},
                                               {"speed", speed_section}}};

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string load() {
  std::string load = "unknown";
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string_view> wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick")
      quick = true;
    else
      wanted.emplace_back(argv[i]);
  }
  for (const auto name : wanted)
    if (std::none_of(kSections.begin(), kSections.end(), [&](const Section& s) { return s.name == name; })) {
      std::fprintf(stderr, "dimension_accuracy: unknown section %s\n", std::string(name).c_str());
      return 64;
    }
  print_text(R"(# Accuracy and speed of the estimators of D

Written whole by `./dev bench-dimension`; what the estimators do and why stands in [fractal.md](fractal.md). Errors
are errors of D, statistics are reproducible (fixed seeds, exact surfaces unless said otherwise), each row stands
beside its target: held, or missed by how much.
)");
  print_text(fmt::format("{}, {} cores, g++ {}{}.\n", processor(), std::thread::hardware_concurrency(), __VERSION__,
                         quick ? "; a tenth of the surfaces only" : ""));
  for (const Section& section : kSections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), section.name) == wanted.end()) continue;
    const std::string before = load();
    section.print();
    if (section.name == "speed")
      print_text("\nOther load (processes that wanted a core) before and after: " + before + ", " + load() + ".");
    std::fprintf(stderr, "dimension_accuracy: %s done\n", std::string(section.name).c_str());
  }
}
