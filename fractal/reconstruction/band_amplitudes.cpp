#include "fractal/reconstruction/band_amplitudes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

/// σ·gain(H)
SCREE_CLONES void amplitude_row(BandGains::Polynomial p, const float* __restrict log_sigma,
                                const float* __restrict hurst, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) {
    const float h = hurst[i] - 0.5F;
    float ends;
    fast_log<float, std::int32_t>(1.0F - 2.0F * h, ends);
    const float log =
        log_sigma[i] + (0.5F * ends + (p[0] + h * (p[1] + h * (p[2] + h * (p[3] + h * (p[4] + h * p[5]))))));
    out[i] = fast_exp(std::min(std::max(log, -80.0F), 80.0F));
  }
}

SCREE_CLONES void add_product(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] += a[i] * b[i];
}

SCREE_CLONES void blend(float share, const float* __restrict a, const float* __restrict b, float* __restrict out,
                        int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] + share * (b[i] - a[i]);
}

/// out[2i] = in[i], out[2i + 1] = the mean of in[i] and in[i + 1], n pairs.
SCREE_CLONES void double_row(const float* __restrict in, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) {
    out[2 * i] = in[i];
    out[2 * i + 1] = 0.5F * (in[i] + in[i + 1]);
  }
}

/// Values of blocks become values of points near their lower corners, one more each way: `own` of the block that begins
/// there and the rest of the one before.
void to_corners(float own, Grid<float>& grid, Grid<float>& scratch) {
  const int rows = grid.rows(), columns = grid.columns();
  scratch.assign(rows + 1, columns + 1, 0.0F);
  for (int r = 0; r <= rows; ++r) {
    const auto here = grid.row(std::min(r, rows - 1)), before = grid.row(std::max(r - 1, 0));
    const auto at = [&](int c) {
      const auto i = static_cast<std::size_t>(c);
      return own * here[i] + (1.0F - own) * before[i];
    };
    for (int c = 0; c <= columns; ++c)
      scratch(r, c) = own * at(std::min(c, columns - 1)) + (1.0F - own) * at(std::max(c - 1, 0));
  }
  std::swap(grid, scratch);
}

int wrapped(std::int32_t coordinate, int side) {
  const int rest = coordinate % side;
  return rest < 0 ? rest + side : rest;
}

/// product += amplitude·(a stretch of a torus' row), piece by piece as it wraps around.
void multiply(std::span<const float> torus, int from, const float* amplitude, int n, float* product) {
  for (int done = 0; done < n;) {
    const int piece = std::min(n - done, static_cast<int>(torus.size()) - from);
    add_product(amplitude + done, torus.data() + from, product + done, piece);
    done += piece;
    from = 0;
  }
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
  const BandGains::Polynomial gain = BandGains::instance().log_gain(band);
  Grid<float>& logs = smooth_.log_sigma;
  Grid<float>& out = amplitude_[static_cast<std::size_t>(band)];
  const int more = every > 1 ? 1 : 0, rows = logs.rows() + more, columns = logs.columns() + more;
  if (out.rows() != rows || out.columns() != columns) out.assign(rows, columns, 0.0F);
  if (every > 1) {
    const float own = 0.5F + 0.5F / static_cast<float>(every);
    to_corners(own, logs, scratch_);
    to_corners(own, smooth_.hurst, scratch_);
  }
  for (int r = 0; r < rows; ++r)
    amplitude_row(gain, logs.row(r).data(), smooth_.hurst.row(r).data(), out.row(r).data(), columns);
}

void BandAmplitudes::set(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int bands) {
  const int coarsest = std::countr_zero(static_cast<unsigned>(OctaveBands::spacing(bands - 1)));
  window_ = window;
  pyramid_.build(law, window, unit_m, cell_m, coarsest + 1);
  amplitude_.resize(static_cast<std::size_t>(bands));
  for (int band = 0; band < bands; ++band) set_band(band);
}

/// out += A_l·B_l at the points of band l.
void BandAmplitudes::add_products(int band, const Grid<float>& torus, CellIndex shift, Grid<float>& out) const {
  const Grid<float>& amplitude = amplitude_[static_cast<std::size_t>(band)];
  const int every = OctaveBands::spacing(band);
  const int x = wrapped((pyramid_.start().x + shift.x) / every, torus.columns());
  for (int r = 0; r < out.rows(); ++r)
    multiply(torus.row(wrapped((pyramid_.start().y + shift.y) / every + r, torus.rows())), x, amplitude.row(r).data(),
             out.columns(), out.row(r).data());
}

void BandAmplitudes::make_field(const Bands& bands, CellIndex shift, Scratch& scratch, PaddedField& u) const {
  const int last = static_cast<int>(amplitude_.size()) - 1;
  Grid<float>& coarse = scratch.coarse;
  for (int band = last; band >= OctaveBands::kFirstCoarse; --band) {
    const Grid<float>& amplitude = amplitude_[static_cast<std::size_t>(band)];
    scratch.finer.assign(amplitude.rows(), amplitude.columns(), 0.0F);
    if (band < last)
      for (int r = 0; r < amplitude.rows(); ++r) {
        const auto upper = coarse.row(r / 2), lower = coarse.row(std::min(r / 2 + r % 2, coarse.rows() - 1));
        scratch.line.resize(upper.size());
        blend(r % 2 == 0 ? 0.0F : 0.5F, upper.data(), lower.data(), scratch.line.data(), coarse.columns());
        double_row(scratch.line.data(), scratch.finer.row(r).data(), coarse.columns() - 1);
        scratch.finer(r, amplitude.columns() - 1) = scratch.line.back();
      }
    std::swap(coarse, scratch.finer);
    add_products(band, bands(band), shift, coarse);
  }
  const int y0 = window_.min.y - pyramid_.start().y, x0 = window_.min.x - pyramid_.start().x, half = x0 / 2;
  scratch.line.resize(static_cast<std::size_t>(3 * coarse.columns()));
  float *line = scratch.line.data(), *doubled = line + coarse.columns();
  for (int r = 0; r < window_.rows; ++r) {
    const int j = (y0 + r) / 2, odd = (y0 + r) % 2;
    blend(0.5F * static_cast<float>(odd), coarse.row(j).data(), coarse.row(j + odd).data(), line, coarse.columns());
    double_row(line + half, doubled, coarse.columns() - 1 - half);
    std::copy_n(doubled + (x0 - 2 * half), window_.columns, u.row(r));
  }
  for (int band = OctaveBands::kFirstCoarse - 1; band >= 0; --band) {
    const Grid<float>& torus = bands(band);
    const int from = wrapped(window_.min.x + shift.x, torus.columns());
    for (int r = 0; r < window_.rows; ++r)
      multiply(torus.row(wrapped(window_.min.y + shift.y + r, torus.rows())), from,
               amplitude_[static_cast<std::size_t>(band)].row(y0 + r).data() + x0, window_.columns, u.row(r));
  }
}

}  // namespace scree::fractal
