// The grounds themselves: which share of them the vehicle cannot stand on.

#include <numbers>

#include "tests/bench/map/report.hpp"
#include "tests/bench/map/truth/must.hpp"
#include "tests/bench/map/truth/scene_truth.hpp"
#include "tests/bench/map/truth/vehicle_truth.hpp"

namespace scree::bench {

void ground_section() {
  for (const bool objects : {true, false})
    for (const double relief : {0.02, 0.03, 0.04, 0.05, 0.06})
      for (const double d : {2.1, 2.4, 2.6, 2.8}) {
        const Ground g = must(make_ground({d, relief, 5, objects}));
        const SceneTruth t = scene_truth(g, {});
        double n = 0, bad = 0, every = 0;
        for (std::size_t i = 0; i < t.worst_share.size(); ++i)
          if (std::isfinite(t.worst_share[i])) n += 1, bad += t.worst_share[i] > 1, every += t.best_share[i] > 1;
        const VehicleOnGround v(g.nodes.height_m, kNode_m, {});
        double p[4] = {0, 0, 0, 0}, m = 0;
        for (int r = 30; r < 850; r += 12)
          for (int c = 30; c < 850; c += 12)
            for (int k = 0; k < 4; ++k) {
              const auto s = v.at(c * kNode_m, r * kNode_m, k * 0.7);
              m += 1, p[0] += s.pitch > 1, p[1] += s.roll > 1, p[2] += s.clearance > 1, p[3] += s.step > 1;
            }
        print_text(fmt::format(
            "objects {} relief {} D {} amp {:.3f}: worst {:.3f} every {:.3f}  pitch {:.3f} roll {:.3f} clear {:.3f} "
            "step {:.3f}",
            objects, relief, d, g.law.amplitude_m, bad / n, every / n, p[0] / m, p[1] / m, p[2] / m, p[3] / m));
      }
}

}  // namespace scree::bench
