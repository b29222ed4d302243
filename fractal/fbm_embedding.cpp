#include "fractal/fbm_embedding.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/fourier.hpp"

namespace scree::fractal {
namespace {

struct Covariance {
  double reach = 1.0;  // R
  double alpha = 1.0, beta = 0.0, c0 = 0.5, c2 = 0.5;

  explicit Covariance(double hurst) : alpha(2.0 * hurst) {
    if (alpha <= 1.5) {
      c2 = alpha / 2.0;
      c0 = 1.0 - alpha / 2.0;
    } else {
      reach = 2.0;
      beta = alpha * (2.0 - alpha) / (3.0 * reach * (reach * reach - 1.0));
      c2 = (alpha - beta * (reach - 1.0) * (reach - 1.0) * (reach + 2.0)) / 2.0;
      c0 = beta * std::pow(reach - 1.0, 3) + 1.0 - c2;
    }
  }
  double operator()(double r_squared) const {
    if (r_squared <= 1.0) return c0 - std::pow(r_squared, alpha / 2.0) + c2 * r_squared;
    const double r = std::sqrt(r_squared);
    return r < reach ? beta * std::pow(reach - r, 3) / r : 0.0;
  }
};

/// Transforms every row of a square quarter of an even-even array, two real rows to one complex transform, and leaves
/// the transposed result: called twice it is the 2-D transform.
void transform_even_rows(std::vector<double>& quarter, int side) {
  const int half = side / 2, n = half + 1;
  Dft<double> dft(side);
  std::vector<std::complex<double>> in(static_cast<std::size_t>(side)), out(in.size());
  const auto at = [n](int row, int column) {
    return static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column);
  };
  for (int row = 0; row < n; row += 2) {
    const int next = std::min(row + 1, n - 1);
    for (int k = 0; k < side; ++k) {
      const int mirrored = k <= half ? k : side - k;
      in[static_cast<std::size_t>(k)] = {quarter[at(row, mirrored)], quarter[at(next, mirrored)]};
    }
    dft.forward(in.data(), out.data());
    for (int k = 0; k < n; ++k) {  // both rows are even, so both transforms are real
      quarter[at(row, k)] = out[static_cast<std::size_t>(k)].real();
      if (next != row) quarter[at(next, k)] = out[static_cast<std::size_t>(k)].imag();
    }
  }
  constexpr int kBlock = 32;
  for (int r0 = 0; r0 < n; r0 += kBlock)
    for (int c0 = r0; c0 < n; c0 += kBlock)
      for (int r = r0; r < std::min(r0 + kBlock, n); ++r)
        for (int c = std::max(c0, r + 1); c < std::min(c0 + kBlock, n); ++c)
          std::swap(quarter[at(r, c)], quarter[at(c, r)]);
}

using ComplexRows = Grid<std::complex<float>>;

/// Frequency rows v = 0 … M/2 of √λ·noise, transformed along u, first `columns` columns kept. The rows between 0 and
/// M/2 stand for their mirror images too, hence √2.
ComplexRows transformed_noise_rows(const FbmEmbedding& embedding, const WhiteNoiseRow& white, int columns) {
  const int side = embedding.side, half = side / 2;
  ComplexRows kept(half + 1, columns);
  Dft<float> dft(side);
  std::vector<std::complex<float>> row(static_cast<std::size_t>(side)), out(row.size());
  std::vector<float> root(static_cast<std::size_t>(half) + 1);
  const double scale = std::pow(embedding.unit_cells, embedding.hurst) / (std::sqrt(2.0) * side);
  for (int v = 0; v <= half; ++v) {
    const double weight = v == 0 || v == half ? scale : scale * std::sqrt(2.0);
    const double* lambda = embedding.eigenvalues.data() + static_cast<std::size_t>(v) * root.size();
    for (std::size_t u = 0; u < root.size(); ++u)
      root[u] = static_cast<float>(weight * std::sqrt(std::max(0.0, lambda[u])));  // rounding may leave −1e-17 λmax
    white(v, row.data());
    for (int u = 0; u < side; ++u)
      row[static_cast<std::size_t>(u)] *= root[static_cast<std::size_t>(std::min(u, side - u))];
    dft.forward(row.data(), out.data());
    std::copy_n(out.begin(), columns, kept.row(v).begin());
  }
  return kept;
}

}  // namespace

double FbmEmbedding::plane_slope_sigma() const {
  return std::sqrt(plane_c2) * std::pow(unit_cells, hurst - 1.0);
}

int embedding_side(double hurst, double longest_lag_cells) {
  return smooth_even_size(static_cast<int>(std::ceil(2.0 * Covariance(hurst).reach * longest_lag_cells)));
}

FbmEmbedding make_embedding(double hurst, int side) {
  const Covariance rho(hurst);
  FbmEmbedding result;
  result.hurst = hurst;
  result.side = side;
  result.unit_cells = side / (2.0 * rho.reach);
  result.plane_c2 = rho.c2;
  const int n = side / 2 + 1;
  result.eigenvalues.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  const double unit2 = result.unit_cells * result.unit_cells;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x <= y; ++x) {
      const double value = rho((static_cast<double>(x) * x + static_cast<double>(y) * y) / unit2);
      result.eigenvalues[static_cast<std::size_t>(y) * n + x] = value;
      result.eigenvalues[static_cast<std::size_t>(x) * n + y] = value;
    }
  transform_even_rows(result.eigenvalues, side);
  transform_even_rows(result.eigenvalues, side);
  return result;
}

WhiteNoiseRow keyed_white_noise(std::uint64_t seed, std::uint64_t stream, int side) {
  return [seed, stream, side](int v, std::complex<float>* row) {
    for (int u = 0; u < side; ++u) {
      const auto normals = random_normals(seed, stream, u, v);
      row[u] = {static_cast<float>(normals[0]), static_cast<float>(normals[1])};
    }
  };
}

Grid<float> embedded_field(const FbmEmbedding& embedding, const WhiteNoiseRow& white, int rows, int columns) {
  const int side = embedding.side, half = side / 2;
  const ComplexRows kept = transformed_noise_rows(embedding, white, columns);
  Grid<float> field(rows, columns);
  Dft<float> dft(side);
  // y(x, ·) is real: its spectrum S_v (0 ≤ v ≤ M/2) is mirrored with conjugation, and two columns a, b go through one
  // transform as A + iB.
  constexpr int kBlock = 8;  // columns gathered together: one cache line of each frequency row
  std::vector<std::complex<float>> block(static_cast<std::size_t>(side) * (kBlock / 2)),
      out(static_cast<std::size_t>(side));
  for (int c0 = 0; c0 < columns; c0 += kBlock) {
    const int pairs = (std::min(kBlock, columns - c0) + 1) / 2;
    for (int v = 0; v <= half; ++v)
      for (int pair = 0; pair < pairs; ++pair) {
        const int c = c0 + 2 * pair;
        const std::complex<float> a = kept(v, c);
        const std::complex<float> b = c + 1 < columns ? kept(v, c + 1) : std::complex<float>{};
        std::complex<float>* spectrum = block.data() + static_cast<std::size_t>(pair) * side;
        if (v == 0 || v == half) {
          spectrum[v] = {a.real(), b.real()};
        } else {
          spectrum[v] = {0.5F * (a.real() - b.imag()), 0.5F * (a.imag() + b.real())};
          spectrum[side - v] = {0.5F * (a.real() + b.imag()), 0.5F * (b.real() - a.imag())};
        }
      }
    for (int pair = 0; pair < pairs; ++pair) {
      const int c = c0 + 2 * pair;
      dft.forward(block.data() + static_cast<std::size_t>(pair) * side, out.data());
      for (int r = 0; r < rows; ++r) {
        field(r, c) = out[static_cast<std::size_t>(r)].real();
        if (c + 1 < columns) field(r, c + 1) = out[static_cast<std::size_t>(r)].imag();
      }
    }
  }
  return field;
}

}  // namespace scree::fractal
