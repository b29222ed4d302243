#include "fractal/reconstruction/band_amplitudes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

SCREE_CLONES void exp_row(float* x, int n) {
  for (int i = 0; i < n; ++i) x[i] = fast_exp(std::min(std::max(x[i], -80.0F), 80.0F));
}

SCREE_CLONES void add_product(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] += a[i] * b[i];
}

int wrapped(std::int32_t coordinate, int side) {
  const int rest = coordinate % side;
  return rest < 0 ? rest + side : rest;
}

}  // namespace

/// The points of band l are corners of blocks, half a cell off: halfway between two blocks, nearly.
void BandAmplitudes::set_band(int band) {
  const int every = OctaveBands::spacing(band), level = std::countr_zero(static_cast<unsigned>(every));
  smooth_ = pyramid_.level(level);
  for (Grid<float>* grid : {&smooth_.log_sigma, &smooth_.hurst}) {
    if (band < 3) {
      const double wavelength = 2.0 * std::numbers::pi / OctaveBands::wavenumber(band);
      smooth_little(*grid, static_cast<float>(std::pow(wavelength / 8.0, 2)), scratch_);
    } else {
      smooth_two(*grid, scratch_);
    }
  }
  const BandGains& gains = BandGains::instance();
  Grid<float>& logs = smooth_.log_sigma;
  for (std::size_t i = 0; i < logs.size(); ++i) logs[i] += gains.log_gain(band, smooth_.hurst[i]);
  Grid<float>& out = amplitude_[static_cast<std::size_t>(band)];
  const int rows = logs.rows() + (every > 1 ? 1 : 0), columns = logs.columns() + (every > 1 ? 1 : 0);
  if (out.rows() != rows || out.columns() != columns) out.assign(rows, columns, 0.0F);
  const float own = every > 1 ? 0.5F + 0.5F / static_cast<float>(every) : 1.0F;
  for (int r = 0; r < rows; ++r) {
    const auto here = logs.row(std::min(r, logs.rows() - 1)), before = logs.row(std::max(r - 1, 0));
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<std::size_t>(std::min(c, logs.columns() - 1));
      const auto j = static_cast<std::size_t>(std::max(c - 1, 0));
      out(r, c) =
          own * (own * here[i] + (1.0F - own) * here[j]) + (1.0F - own) * (own * before[i] + (1.0F - own) * before[j]);
    }
    exp_row(out.row(r).data(), columns);
  }
}

void BandAmplitudes::set(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int bands) {
  const int coarsest = std::countr_zero(static_cast<unsigned>(OctaveBands::spacing(bands - 1)));
  pyramid_.build(law, window, unit_m, cell_m, coarsest + 1);
  amplitude_.resize(static_cast<std::size_t>(bands));
  for (int band = 0; band < bands; ++band) set_band(band);
}

void BandAmplitudes::add_row(int band, const Grid<float>& torus, CellIndex shift, CellIndex cell, int count,
                             std::vector<float>& line, float* out) const {
  const int every = OctaveBands::spacing(band);
  const int y = cell.y - pyramid_.start().y, x = cell.x - pyramid_.start().x;
  // Piece by piece, as the torus wraps around.
  const auto multiply = [&](int row, int first, int n, float* product) {
    const float* amplitude = this->row(band, row);
    const float* values = torus.row(wrapped((pyramid_.start().y + shift.y) / every + row, torus.rows())).data();
    int from = wrapped((pyramid_.start().x + shift.x) / every + first, torus.columns());
    for (int done = 0; done < n;) {
      const int piece = std::min(n - done, torus.columns() - from);
      add_product(amplitude + first + done, values + from, product + done, piece);
      done += piece;
      from = 0;
    }
  };
  if (every == 1) return multiply(y, x, count, out);
  const int row = y / every, first = x / every, n = (x + count - 1) / every + 2 - first;
  line.assign(2 * static_cast<std::size_t>(n), 0.0F);
  float *upper = line.data(), *lower = line.data() + n;
  multiply(row, first, n, upper);
  multiply(row + 1, first, n, lower);
  const float down = static_cast<float>(y % every) / static_cast<float>(every);
  for (int i = 0; i < n; ++i) upper[i] += down * (lower[i] - upper[i]);
  for (int i = 0, at = x - first * every; i < count;) {
    const int j = at / every, into = at % every, n_cells = std::min(every - into, count - i);
    const float step = (upper[j + 1] - upper[j]) / static_cast<float>(every);
    for (int m = 0; m < n_cells; ++m) out[i + m] += upper[j] + step * static_cast<float>(into + m);
    i += n_cells;
    at += n_cells;
  }
}

}  // namespace scree::fractal
