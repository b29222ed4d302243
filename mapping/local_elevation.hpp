#pragma once
// Ground between what was measured: posterior mean, standard deviation and coherent rough draws, frame after frame.

#include <optional>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "fractal/reconstruction/innovation_calibration.hpp"
#include "mapping/ground_layers.hpp"

namespace scree::mapping {

struct LocalElevationConfig {
  double cell_m = 0.1;
  int size_cells = 200;
  int draws = 8;
  std::uint64_t seed = 1;
};

/// The conditional reconstruction (fractal/reconstruction/conditional.hpp) with a law for each cell, below the rays.
/// What a frame measures where the last one only had a prediction tells how good predictions are: their normalised
/// innovations e²/(v + R) set the amplitude's factor around there (innovation_calibration.hpp), so that intervals keep
/// covering what they say.
class LocalElevation {
 public:
  explicit LocalElevation(const LocalElevationConfig& config);

  /// `law`: of the heights at `window`. `predicted`: 1 = cells that the map vouches for between measured ones; ceilings
  /// count there alone, and innovations are learnt from there. Null while nothing was ever measured. Valid until the
  /// next call; the caller may take the draws away.
  fractal::Reconstruction* update(const GroundLayers& ground, const LatticeWindow& window, const fractal::LawMap& law,
                                  const Grid<std::uint8_t>& predicted, Executor& executor);

 private:
  void learn(const GroundLayers& ground, const LatticeWindow& window, Executor& executor);
  void calibrate(const fractal::LawMap& law);
  void remember(const GroundLayers& ground, const LatticeWindow& window, const Grid<std::uint8_t>& predicted,
                Executor& executor);
  void set_ceilings(const GroundLayers& ground, const Grid<std::uint8_t>& predicted, Executor& executor);

  LocalElevationConfig config_;
  fractal::ConditionalReconstructor reconstructor_;
  fractal::InnovationCalibration calibration_;
  fractal::LawMap law_;  ///< with what was learnt
  fractal::Reconstruction filled_;
  Grid<float> ceiling_m_;

  LatticeWindow last_window_;          ///< no rows: nothing predicted yet
  Grid<float> predicted_mean_m_;       ///< of cells that were predicted and not measured; NaN elsewhere
  Grid<float> predicted_variance_m2_;  ///< by the law without its factor
  Grid<float> squared_ratio_;
};

}  // namespace scree::mapping
