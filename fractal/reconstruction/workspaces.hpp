#pragma once
// Work space of solves that may run side by side.

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "fractal/reconstruction/band_amplitudes.hpp"
#include "fractal/reconstruction/blend_solver.hpp"
#include "fractal/reconstruction/ceiling_push.hpp"

namespace scree::fractal {

/// What one solve needs while it runs; every field of it is overwritten by the next.
struct Workspace {
  PaddedField u, x, b;
  BandAmplitudes::Scratch bands;
  BlendSolver solver;
  CeilingPush push;
};

/// As many workspaces as solves run at once: a lone thread does all of them in one, which stays in its cache.
class Workspaces {
 public:
  std::unique_ptr<Workspace> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Workspace>();
    std::unique_ptr<Workspace> last = std::move(free_.back());
    free_.pop_back();
    return last;
  }
  void give(std::unique_ptr<Workspace> workspace) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(workspace));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> free_;
};

}  // namespace scree::fractal
