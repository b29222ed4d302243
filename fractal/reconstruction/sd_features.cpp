#include "fractal/reconstruction/sd_features.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

constexpr double kDensityReach = 0.6;  // sd of the smoothing over the spacing of the data
constexpr int kMaxRadius = 64;
constexpr float kMostChange = 4.0F;     // a law that jumps must not decide the fit alone
constexpr double kLeastDensity = 0.05;  // of the mean: where the smoothing sees no datum at all

SCREE_CLONES void log_of(const float* x, float factor, float lowest, float* out, int n) {
  for (int i = 0; i < n; ++i) {
    float log;
    fast_log<float, std::int32_t>(factor * x[i] > lowest ? factor * x[i] : lowest, log);
    out[i] = log;
  }
}

/// 1 where there is a variance; returns how many.
SCREE_CLONES int mark_row(const float* __restrict variance, std::uint8_t* __restrict measured, int n) {
  int count = 0;
  for (int i = 0; i < n; ++i) {
    const int is = variance[i] > 0.0F ? 1 : 0;  // not a NaN
    measured[i] = static_cast<std::uint8_t>(is);
    count += is;
  }
  return count;
}

SCREE_CLONES void to_float(const std::uint8_t* __restrict from, float* __restrict to, int n) {
  for (int i = 0; i < n; ++i) to[i] = static_cast<float>(from[i]);
}

/// Mean of what is around, without what the cell itself adds.
SCREE_CLONES void without_own(const float* __restrict smoothed, const std::uint8_t* __restrict measured, float own,
                              const float* __restrict inside, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = (smoothed[i] - own * static_cast<float>(measured[i])) / inside[i];
}

/// Distances of unmeasured cells; of measured ones the distance that the density lets expect without them.
SCREE_CLONES void log_distances(const std::int32_t* __restrict squared, const float* __restrict log_rho,
                                float* __restrict out, int n) {
  constexpr float kLog2 = 0.69314718F;
  for (int i = 0; i < n; ++i) {
    float log;
    fast_log<float, std::int32_t>(static_cast<float>(std::max(squared[i], 1)), log);
    const float alone = std::max(-0.5F * log_rho[i] - kLog2, 0.0F);
    out[i] = squared[i] == 0 ? alone : 0.5F * log;
  }
}

SCREE_CLONES void multiply(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] * b[i];
}

/// Squares of differences across and along, each times its scale.
SCREE_CLONES void change_row(const float* __restrict left, const float* __restrict right, float x_scale,
                             const float* __restrict above, const float* __restrict below, float y_scale,
                             float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) {
    const float x = x_scale * (right[i] - left[i]), y = y_scale * (below[i] - above[i]), square = x * x + y * y;
    out[i] = square < kMostChange ? square : kMostChange;
  }
}

}  // namespace

void SdFeatures::measure(const Grid<float>& variance_m2, Executor& executor) {
  const int rows = variance_m2.rows(), columns = variance_m2.columns();
  if (measured_.rows() != rows || measured_.columns() != columns) {
    measured_.assign(rows, columns, 0);
    for (Grid<float>* grid : {&log_d_, &log_rho_}) grid->assign(rows, columns, 0.0F);
  }
  int count = 0;
  for (int r = 0; r < rows; ++r) count += mark_row(variance_m2.row(r).data(), measured_.row(r).data(), columns);
  measured_cells_ = count;
  spacing_cells_ = std::sqrt(static_cast<double>(variance_m2.size()) / std::max(measured_cells_, 1.0));
  if (count == 0) return;
  distance_.transform(measured_, executor, squared_);
  measure_density(executor);
}

void SdFeatures::measure_density(Executor& executor) {
  const int rows = measured_.rows(), columns = measured_.columns();
  density_.resize(rows, columns, std::min(BoxCascade::radius_of(kDensityReach * spacing_cells_), kMaxRadius));
  for (int r = 0; r < rows; ++r) to_float(measured_.row(r).data(), density_.row(r).data(), columns);
  density_.smooth();
  const auto least = static_cast<float>(kLeastDensity / (spacing_cells_ * spacing_cells_));
  const auto logs = [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const auto inside = density_.weight_of_columns();
      const float own = density_.own_weight();
      float* rho = log_rho_.row(r).data();
      without_own(density_.smoothed(r).data(), measured_.row(r).data(), own, inside.data(), rho, columns);
      log_of(rho, 1.0F / density_.weight_of_row(r), least, rho, columns);
      log_distances(squared_.row(r).data(), rho, log_d_.row(r).data(), columns);
    }
  };
  for_rows(executor, rows, logs);
}

void SdFeatures::measure_law(const LawMap& law, double cell_m, Executor& executor) {
  const int rows = measured_.rows(), columns = measured_.columns();
  if (log_unit2_.rows() != rows || log_unit2_.columns() != columns)
    for (Grid<float>* grid : {&log_unit2_, &change_}) grid->assign(rows, columns, 0.0F);
  const auto log_cell = static_cast<float>(2.0 * std::log(cell_m));
  const auto logs = [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      float* unit2 = log_unit2_.row(r).data();
      log_of(law.amplitude_m.row(r).data(), 1.0F, 1e-30F, unit2, columns);
      const float* dimension = law.dimension.row(r).data();
      for (int c = 0; c < columns; ++c) unit2[c] = 2.0F * unit2[c] + log_cell * (3.0F - dimension[c]);
    }
  };
  executor.for_ranges(rows, std::ref(logs));
  const auto changes = [&](int begin, int end) {
    for (int r = begin; r < end; ++r) measure_change(r);
  };
  executor.for_ranges(rows, std::ref(changes));
}

void SdFeatures::measure_change(int row) {
  const int rows = measured_.rows(), columns = measured_.columns();
  const int half = std::clamp(static_cast<int>(std::lround(0.5 * spacing_cells_)), 1, kMaxRadius);
  const auto spacing = static_cast<float>(spacing_cells_);
  const int up = std::max(row - half, 0), down = std::min(row + half, rows - 1);
  const float *here = log_unit2_.row(row).data(), *above = log_unit2_.row(up).data(),
              *below = log_unit2_.row(down).data();
  const float y_scale = spacing / static_cast<float>(std::max(down - up, 1));
  float* change = change_.row(row).data();
  const auto cells = [&](int begin, int end, int reach_left, int reach_right) {
    const float x_scale = spacing / static_cast<float>(std::max(reach_left + reach_right, 1));
    change_row(here + begin - reach_left, here + begin + reach_right, x_scale, above + begin, below + begin, y_scale,
               change + begin, end - begin);
  };
  const int inner_end = std::max(columns - half, 0), inner = std::min(half, inner_end);
  for (int c = 0; c < inner; ++c) cells(c, c + 1, c, std::min(half, columns - 1 - c));
  cells(inner, inner_end, half, half);
  for (int c = inner_end; c < columns; ++c) cells(c, c + 1, std::min(half, c), columns - 1 - c);
}

void SdFeatures::load(int row, int begin, const LawMap& law, double cell_m, Block& block) const {
  const int n = block.n = std::min(kBlock, measured_.columns() - begin);
  block.terms = terms(law);
  const float *d = log_d_.row(row).data() + begin, *rho = log_rho_.row(row).data() + begin;
  std::copy_n(d, n, block.x[0].data());
  multiply(d, d, block.x[1].data(), n);
  std::copy_n(rho, n, block.x[2].data());
  multiply(d, rho, block.x[3].data(), n);
  if (!law.varies()) {
    std::fill_n(block.log_unit2.data(), n, static_cast<float>(2.0 * std::log(law.law.rms_change_m(cell_m))));
    return;
  }
  for (int i = 0; i < n; ++i) block.x[4][static_cast<std::size_t>(i)] = 3.0F - law.dimension(row, begin + i);
  multiply(block.x[4].data(), d, block.x[5].data(), n);
  multiply(block.x[4].data(), rho, block.x[6].data(), n);
  std::copy_n(change_.row(row).data() + begin, n, block.x[7].data());
  std::copy_n(log_unit2_.row(row).data() + begin, n, block.log_unit2.data());
}

}  // namespace scree::fractal
