// The resident memory of the process while a mapper takes frame after frame.

#include <fstream>
#include <unistd.h>

#include "mapping/mapper.hpp"
#include "tests/bench/map/going.hpp"
#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/must.hpp"

namespace scree::bench {
namespace {

double resident_mb() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

void memory_section() {
  const int frames = soak ? 10000 : (quick ? 200 : 1000);
  print_text(fmt::format(R"(
## Memory

Resident memory of the process, a mapper of 200 × 200 cells taking {} frames of 256 × 256 (`--soak`: 10,000), each snapshot
held until the next; and how much of it is more than before there was a mapper: the mapper's own.

| frames | resident (MB) | the mapper's (MB) | more than after the first 100 |
|---|---|---|---|)",
                         frames));
  EndlessDrive drive("perceptron-cmu");
  const double before_mb = resident_mb();
  SerialExecutor serial;
  mapping::Mapper mapper({}, serial);
  std::shared_ptr<const mapping::MapSnapshot> held;
  double first_mb = 0.0;
  for (int i = 1; i <= frames; ++i) {
    must(mapper.step(drive.next()));
    held = mapper.snapshot();
    if (i == 100) first_mb = resident_mb();
    if (i == 100 || (i > 100 && i % (frames / 5) == 0))
      print_text(fmt::format("| {} | {:.1f} | {:.1f} | {:+.1f} |", i, resident_mb(), resident_mb() - before_mb,
                             resident_mb() - first_mb));
  }
  print_text("\nConstant to 1 MB: " + at_most(resident_mb() - first_mb, 1.0) + ".");
}

}  // namespace scree::bench
