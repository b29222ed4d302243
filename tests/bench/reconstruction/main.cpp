// The measured tables of docs/reconstruction.md, as Markdown on stdout. Arguments: --quick (a tenth of the surfaces),
// --pictures FOLDER (figures of the sections that have some), names of sections (default: all).

#include <algorithm>
#include <array>
#include <string_view>

#include "tests/bench/reconstruction/report.hpp"

namespace {

using namespace scree::bench;

struct Section {
  std::string_view name;
  void (*print)();
};
constexpr std::array kSections = {
    Section{"conditional", conditional_section},
    Section{"varying", varying_section},
    Section{"oracle", oracle_section},
    Section{"holes", holes_section},
    Section{"calibration", calibration_section},
    Section{"speed", speed_section},
    Section{"large", large_section},
    Section{"delaunay", delaunay_section},
    Section{"polyhedron", polyhedron_section},
    Section{"barycentre", barycentre_section},
    Section{"combined", combined_section},
    Section{"fbm", fbm_section},
    Section{"sd", sd_section},
    Section{"outliers", outliers_section},
    Section{"cliffs", cliffs_section},
    Section{"occlusion", occlusion_section},
    Section{"robust-varying", robust_varying_section},
    Section{"methods", methods_section},
    Section{"kriging", kriging_section},
    Section{"sampler", sampler_section},
    Section{"paper-tables", paper_tables_section},
    Section{"peers", peers_section},
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string_view> wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick")
      quick = true;
    else if (std::string_view(argv[i]) == "--pictures" && i + 1 < argc)
      pictures = argv[++i];
    else
      wanted.emplace_back(argv[i]);
  }
  for (const auto name : wanted)
    if (std::none_of(kSections.begin(), kSections.end(), [&](const Section& s) { return s.name == name; })) {
      std::fprintf(stderr, "reconstruction_accuracy: unknown section %s\n", std::string(name).c_str());
      return 64;
    }
  if (wanted.empty())
    print_text(R"(# Reconstruction, measured

Written whole by `./dev bench-reconstruction`, section by section as `reconstruction_accuracy` prints them (`./dev
bench-reconstruction NAME` for one); what the methods do and why stands in [reconstruction.md](reconstruction.md). Surfaces
are exact fBm unless said otherwise, statistics reproducible (fixed seeds); times are of the machine that ran it, ratios are
what to trust.)");
  for (const Section& section : kSections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), section.name) == wanted.end()) continue;
    section.print();
    std::fprintf(stderr, "reconstruction_accuracy: %s done\n", std::string(section.name).c_str());
  }
}
