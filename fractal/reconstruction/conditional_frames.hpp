#pragma once
// What ConditionalReconstructor keeps from frame to frame, and the steps of a frame.

#include <memory>
#include <vector>

#include "fractal/reconstruction/band_tiles.hpp"
#include "fractal/reconstruction/ceiling_push.hpp"
#include "fractal/reconstruction/ceiling_sums.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/kept_solution.hpp"
#include "fractal/reconstruction/residual_tile.hpp"
#include "fractal/reconstruction/sd_map.hpp"
#include "fractal/reconstruction/workspaces.hpp"

namespace scree::fractal {

/// The heights of one frame, grids of one shape. ceiling_m may be empty.
struct FrameData {
  const Grid<float>& height_m;
  const Grid<float>& variance_m2;
  const Grid<float>& ceiling_m;
};

struct ConditionalReconstructor::Solver {
  explicit Solver(const ReconstructionConfig& c);

  ReconstructionConfig config;
  ResidualTiles tiles;
  std::unique_ptr<BandTiles> bands;
  BandAmplitudes amplitudes;
  bool varies = false;
  Conditioning problem;
  LatticeWindow window;
  Workspaces workspaces;
  std::vector<KeptSolution> kept;  // mean, residual 0, 1, …; metres
  std::vector<SolveReport> reports;

  std::vector<KeptSolution> pushes;  // of each field below the ceilings, metres
  std::vector<std::uint8_t> pushed;  // did the field need one in this frame?
  Grid<float> ceiling;               // in units less the level, NaN = none
  Grid<float> change;                // of the law over a cell, in units, where there is a ceiling; empty for one law
  CeilingSums sums;
  SdMap sd_map;
  Grid<float> measured_variance;  // m², NaN where not measured

  int fields() const { return static_cast<int>(kept.size()) - 1; }
  void run(const FrameData& data, const LawMap& law, Executor& executor, Reconstruction& out);

 private:
  void prepare_fields(const LawMap& law);
  void start_mean(const Grid<float>& height_m, Workspace& work) const;
  double start_residual(int k, Workspace& work) const;
  void keep(int task, const Workspace& work);
  void solve(int task, const Grid<float>& height_m);

  void set_ceilings(const FrameData& data, const LawMap& law);
  void push(int k);
  void write_row(int r, Reconstruction& out) const;
  void write(Executor& executor, Reconstruction& out) const;
  void write_sd(const FrameData& data, const LawMap& law, Executor& executor, Reconstruction& out);
  void write_pushes(const FrameData& data, Executor& executor, Reconstruction& out);
};

}  // namespace scree::fractal
