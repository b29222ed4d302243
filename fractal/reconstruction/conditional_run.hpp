#pragma once
// One reconstruction by the conditional method, its input checked.

#include <memory>
#include <optional>
#include <vector>

#include "fractal/reconstruction/blend_fit.hpp"
#include "fractal/reconstruction/ceiling_sums.hpp"
#include "fractal/reconstruction/field_solve.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/reconstruction/sd_map.hpp"

namespace scree::fractal {

/// See reconstruct_conditional.hpp; the outlier gate comes before.
class ConditionalRun {
 public:
  static constexpr std::size_t kSideBySide = std::size_t{1}
                                             << 20;  ///< cells: up to here some fields are solved at once
  static constexpr int kTogether = 4;

  ConditionalRun(const CellSamples& samples, const SurfaceRequest& request, const ConditionalOptions& options);
  /// Once.
  SurfaceEstimate run(Executor& executor);

 private:
  bool pushes() const { return !options_.ceiling_m.empty(); }
  bool keeps_draws() const { return pushes() || options_.break_edges; }
  void progress(int done) const;
  void count(const SolveReport& report);
  void solve_mean(const Conditioning& problem);
  void break_mean(Conditioning& problem);
  void set_ceilings(const Conditioning& problem);
  void write_mean(const Conditioning& problem);
  std::unique_ptr<ResidualFields> residual_fields_of(const Conditioning& problem) const;
  void solve_fields(const Conditioning& problem, Executor& executor);
  void take(const Conditioning& problem, const FieldSolve& solve, int k);
  void inflate(const SdMap& sd, double unit_m);
  void give_draws(const Grid<float>& plain_sd_m);

  const CellSamples& samples_;
  const SurfaceRequest& request_;
  const ConditionalOptions& options_;
  int fields_;
  double field_tolerance_;
  PaddedField mean_;     // in units less the level
  Grid<float> change_;   // of the law over a cell, in units; empty for one law
  Grid<float> ceiling_;  // in units less the level
  std::optional<BlendFit> breaks_;
  CeilingSums sums_;
  Grid<float> square_, draw_;
  std::vector<Grid<float>> draws_;  // to be given, less the mean without pushes
  int given_ = 0;
  SurfaceEstimate out_;
};

}  // namespace scree::fractal
