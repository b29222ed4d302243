#include "fractal/reconstruction/reconstruct_conditional.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

#include "fractal/reconstruction/conditioning.hpp"
#include "fractal/reconstruction/data_gaps.hpp"
#include "fractal/reconstruction/residual_fields.hpp"
#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::fractal {
namespace {

using ::testing::HasSubstr;

class Backwards final : public Executor {
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int i = count; i-- > 0;) body(i, i + 1);
  }
};

SurfaceRequest request_of(const SparseScene& scene, std::vector<Grid<float>>* draws = nullptr, int count = 1) {
  SurfaceRequest request{
      {scene.height.rows(), scene.height.columns(), kSceneCellM}, {scene.law, {}, {}}, count, 1, {}, {}};
  if (draws != nullptr) request.on_draw = [draws](int, const Grid<float>& draw) { draws->push_back(draw); };
  return request;
}

LawMap flat(const FractalLaw& law, int rows, int columns) {
  LawMap map{law, Grid<float>(rows, columns, static_cast<float>(law.dimension)),
             Grid<float>(rows, columns, static_cast<float>(law.amplitude_m))};
  return map;
}

// 2 surfaces of 160² at each D, K = 8: the coverage of 95 % of 25600 cells whose errors are correlated over a spacing
// (4.5 cells) has a standard error of about √(.09/(2·25600/20)) = .006, and the sd map errs by up to 9 %, coverage .01;
// bound .03, false alarms below 1e-3. D^ of the two draws: published bias .015 and 4 s.e. of .004.
TEST(ReconstructConditional, CoversAndIsAsRoughAsTheGround) {
  SerialExecutor serial;
  for (const bool varies : {false, true})
    for (const double dimension : {2.2, 2.5, 2.8}) {
      PredictionScore score;
      double rougher = 0.0;
      for (std::uint64_t seed = 20; seed < 22; ++seed) {
        const SparseScene scene(dimension, 160, 160, 0.05, seed);
        std::vector<Grid<float>> draws;
        SurfaceRequest request = request_of(scene, &draws);
        if (varies) request.law = flat(scene.law, 160, 160);
        const SurfaceEstimate out = *reconstruct_conditional(scene.cells(), request, {}, serial);
        EXPECT_TRUE(out.converged);
        ASSERT_EQ(draws.size(), 1u);
        rougher += 0.5 * (axis_dimension(draws[0]) - axis_dimension(scene.truth));
        score += score_prediction(scene.truth, out.mean_m, out.sd_m, scene.law.rms_change_m(kSceneCellM),
                                  [&](int r, int c) { return std::isnan(scene.height(r, c)); });
      }
      EXPECT_NEAR(score.coverage(), 0.9, 0.03) << dimension << (varies ? " varying" : "");
      EXPECT_NEAR(rougher, 0.0, 0.031) << dimension << (varies ? " varying" : "");
    }
}

/// Mean square of the residuals of eight fields made on a torus of `side`, in units of the change over a cell.
double residual_square(const SparseScene& scene, int side) {
  const SurfaceGrid grid{scene.height.rows(), scene.height.columns(), kSceneCellM};
  Conditioning problem;
  problem.load(scene.height, scene.variance, {scene.law, {}, {}}, {0, 0}, kSceneCellM);
  const auto fields = one_law_fields(scene.law.hurst(), side, grid, 1);
  double sum = 0.0;
  PaddedField u, b, x;
  BlendSolver solver;
  for (int k = 0; k < 8; ++k) {
    for (PaddedField* field : {&u, &b, &x}) field->resize(problem.shape().rows, problem.shape().columns);
    fields->make(k, u);
    problem.residual_problem(u, b);
    solver.solve(problem.matrix(), b, 0.02, 60, x);
    for (int r = 0; r < grid.rows; ++r)
      for (int c = 0; c < grid.columns; ++c) sum += std::pow(static_cast<double>(u.row(r)[c] - x.row(r)[c]), 2);
  }
  return sum / (8.0 * grid.rows * grid.columns);
}

// A torus an eighth larger than the window instead of one that holds its diagonal exactly: what the data do not fix is
// a few spacings long. 8 fields of 200² cells: errors are correlated over a spacing, 4.5 cells, so either mean square
// has a standard error of √(2/(8·40000/20)) = 1.1 %, the ratio 1.6 %; bound 4 of them.
TEST(ReconstructConditional, ASmallTorusLeavesTheSameResiduals) {
  for (const double dimension : {2.2, 2.6}) {
    const SparseScene scene(dimension, 200, 200, 0.05, 3);
    EXPECT_NEAR(residual_square(scene, 240) / residual_square(scene, 1200), 1.0, 0.064) << dimension;
  }
}

TEST(ReconstructConditional, TheTorusIsExactWhereThatIsCheapOrTheGapsAreWide) {
  EXPECT_GE(residual_torus_side(0.5, 256, 256, 16), 724);   // twice the diagonal
  EXPECT_GE(residual_torus_side(0.8, 256, 256, 16), 1448);  // four times above H = 3/4
  EXPECT_GE(residual_torus_side(0.5, 3000, 3000, 32), 3300);
  EXPECT_LT(residual_torus_side(0.5, 3000, 3000, 32), 3600);
  EXPECT_GE(residual_torus_side(0.5, 3000, 3000, 512), 8000);
}

TEST(ReconstructConditional, FindsTheWidestGap) {
  Grid<float> height(100, 60, 1.0F);
  EXPECT_EQ(widest_gap_cells(height), 1);
  height(50, 50) = NAN;
  EXPECT_EQ(widest_gap_cells(height), 2);
  for (float& z : height) z = NAN;
  height(3, 3) = 1.0F;
  EXPECT_EQ(widest_gap_cells(height), 128);
}

TEST(ReconstructConditional, IsTheSameWithAnyThreadsAndMoreDraws) {
  const SparseScene scene(2.4, 70, 90, 0.1, 5);
  SerialExecutor serial;
  Backwards backwards;
  std::vector<Grid<float>> draws, more;
  const SurfaceEstimate a = *reconstruct_conditional(scene.cells(), request_of(scene, &draws), {}, serial);
  const SurfaceEstimate b = *reconstruct_conditional(scene.cells(), request_of(scene, &more, 3), {}, backwards);
  EXPECT_EQ(a.mean_m, b.mean_m);
  EXPECT_EQ(a.sd_m, b.sd_m);
  ASSERT_EQ(more.size(), 3u);
  EXPECT_EQ(draws[0], more[0]);
  EXPECT_NE(more[0], more[1]);
}

TEST(ReconstructConditional, OneDatumIsEnoughAndNoneIsAnError) {
  SparseScene scene(2.5, 40, 60, 0.0, 7);
  SerialExecutor serial;
  EXPECT_THAT(reconstruct_conditional(scene.cells(), request_of(scene), {}, serial).error().message,
              HasSubstr("expected at least 1 measured cell in 40 x 60, found 0"));
  scene.height(20, 30) = 5.0F;
  scene.variance(20, 30) = 1e-4F;
  const auto out = reconstruct_conditional(scene.cells(), request_of(scene), {}, serial);
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->mean_m(0, 0), 5.0, 1e-3);
  EXPECT_GT(out->sd_m(0, 0), out->sd_m(20, 29));
}

TEST(ReconstructConditional, SaysWhatIsWrongWithALawMap) {
  const SparseScene scene(2.5, 30, 30, 0.2, 7);
  SerialExecutor serial;
  SurfaceRequest request = request_of(scene);
  request.law = flat(scene.law, 30, 20);
  EXPECT_THAT(reconstruct_conditional(scene.cells(), request, {}, serial).error().message,
              HasSubstr("expected a law for each of 30 x 30 cells, found 30 x 20"));
  request.law = flat(scene.law, 30, 30);
  request.law.dimension(3, 4) = 3.0F;
  EXPECT_THAT(reconstruct_conditional(scene.cells(), request, {}, serial).error().message,
              HasSubstr("in cell (3, 4), found D = 3"));
  EXPECT_FALSE(reconstruct_conditional(scene.cells(), request_of(scene), {.residual_fields = 0}, serial));
}

TEST(ReconstructConditional, MemoryGrowsWithTheGrid) {
  const auto bytes = [](int side, bool varies) {
    return static_cast<double>(conditional_memory_bytes(side, side, varies)) / side / side;
  };
  EXPECT_NEAR(bytes(8192, false) / bytes(2048, false), 1.0, 0.2);
  EXPECT_LT(bytes(8192, false) * 8192 * 8192, 23e9 / 2);
  EXPECT_LT(bytes(8192, true) * 8192 * 8192, 23e9 / 1.5);
  const auto with = [](const ConditionalLoad& load) { return conditional_memory_bytes(1024, 1024, false, load); };
  EXPECT_EQ(with({.kept_draws = 10}), with({}) + std::size_t{40} * 1024 * 1024);
  EXPECT_GT(with({.ceilings = true}), with({}));
  EXPECT_GT(with({.gap_cells = 512}), with({.gap_cells = 8}));
}

}  // namespace
}  // namespace scree::fractal
