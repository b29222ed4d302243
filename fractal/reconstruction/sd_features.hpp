#pragma once
// What the variance of a cell depends on: where the data are, and the law.

#include <array>
#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/box_cascade.hpp"
#include "fractal/reconstruction/distance_transform.hpp"
#include "fractal/reconstruction/log_regression.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// Distance d of every cell to the nearest datum (of a measured cell: half the spacing of the data around it, what the
/// nearest would be without its own) and density ρ of data around it, as logarithms.
class SdFeatures {
 public:
  static constexpr int kBlock = 256;
  /// A stretch of a row, so that the features of a map are never stored.
  struct Block {
    int n = 0, terms = 0;
    /// log d, log² d, log ρ, log d·log ρ; of a varying law also H, H·log d, H·log ρ, and how σ² changes: |∇ ln σ²|²
    /// over a spacing of the data.
    alignas(64) std::array<std::array<float, kBlock>, LogRegression::kMaxTerms - 1> x;
    alignas(64) std::array<float, kBlock> log_unit2;  ///< log of the law's (rms change over a cell)², m²
  };
  static int terms(const LawMap& law) { return law.varies() ? 9 : 5; }

  /// `variance_m2` > 0 where measured, else NaN. No allocation when shape and density stay.
  void measure(const Grid<float>& variance_m2, Executor& executor);
  /// After measure(): logarithms and changes of a varying law, of the shape measured.
  void measure_law(const LawMap& law, double cell_m, Executor& executor);
  void load(int row, int begin, const LawMap& law, double cell_m, Block& block) const;

  const Grid<std::uint8_t>& measured() const { return measured_; }
  double measured_cells() const { return measured_cells_; }
  double spacing_cells() const { return spacing_cells_; }  ///< 1/√(share of measured cells)

 private:
  void measure_density(Executor& executor);
  void measure_change(int row);

  double measured_cells_ = 0.0, spacing_cells_ = 1.0;
  Grid<std::uint8_t> measured_;
  Grid<std::int32_t> squared_;
  Grid<float> log_d_, log_rho_, log_unit2_, change_;
  DistanceTransform distance_;
  BoxCascade density_;
};

}  // namespace scree::fractal
