#include "fractal/lattice_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fractal/fourier.hpp"

namespace scree::fractal {
namespace {

using Complex = std::complex<double>;
using Shape = LatticeShape;
constexpr int kBlock = 8;  // rows gathered together: whole cache lines on the strided side

/// Rows transformed along x and turned: element (kx, y), zero behind the last row.
Grid<Complex> transformed_rows(const Shape& shape, const Grid<Complex>& field, Executor& executor) {
  Grid<Complex> turned(shape.side_x, shape.side_y);
  executor.for_ranges((shape.rows + kBlock - 1) / kBlock, [&](int begin, int end) {
    Dft<double> dft(shape.side_x);
    const auto side = static_cast<std::size_t>(shape.side_x);
    std::vector<Complex> line(side), block(side * kBlock);
    for (int first = begin * kBlock; first < std::min(end * kBlock, shape.rows); first += kBlock) {
      const int count = std::min(kBlock, shape.rows - first);
      for (int k = 0; k < count; ++k) {
        const auto row = field.row(first + k);
        std::copy(row.begin(), row.end(), line.begin());
        dft.forward(line.data(), block.data() + static_cast<std::size_t>(k) * side);
      }
      for (int x = 0; x < shape.side_x; ++x)
        for (int k = 0; k < count; ++k)
          turned(x, first + k) = block[static_cast<std::size_t>(k) * side + static_cast<std::size_t>(x)];
    }
  });
  return turned;
}

/// The same for a real field, two rows to a transform, kx = 0 … side/2 only.
Grid<Complex> transformed_real_rows(const Shape& shape, const Grid<double>& field, Executor& executor) {
  const int half = shape.side_x / 2;
  Grid<Complex> turned(half + 1, shape.side_y);
  executor.for_ranges((shape.rows + kBlock - 1) / kBlock, [&](int begin, int end) {
    Dft<double> dft(shape.side_x);
    const auto side = static_cast<std::size_t>(shape.side_x);
    std::vector<Complex> line(side), block(side * kBlock / 2);
    for (int first = begin * kBlock; first < std::min(end * kBlock, shape.rows); first += kBlock) {
      const int pairs = (std::min(kBlock, shape.rows - first) + 1) / 2;
      for (int k = 0; k < pairs; ++k) {
        const int y = first + 2 * k;
        for (int x = 0; x < shape.columns; ++x)
          line[static_cast<std::size_t>(x)] = {field(y, x), y + 1 < shape.rows ? field(y + 1, x) : 0.0};
        dft.forward(line.data(), block.data() + static_cast<std::size_t>(k) * side);
      }
      for (int x = 0; x <= half; ++x)
        for (int k = 0; k < pairs; ++k) {
          const Complex* out = block.data() + static_cast<std::size_t>(k) * side;
          const Complex a = out[x], b = std::conj(out[x == 0 ? 0 : shape.side_x - x]);
          turned(x, first + 2 * k) = 0.5 * (a + b);
          const Complex difference = 0.5 * (a - b);
          if (first + 2 * k + 1 < shape.side_y) turned(x, first + 2 * k + 1) = {difference.imag(), -difference.real()};
        }
    }
  });
  return turned;
}

/// (Σ(z − z')², pairs) by offset as real and imaginary part: column kx of its transform along y, from those of n + i q
/// and of s. Both parts are real and even, so forward and inverse transform are one.
void combine(const Shape& shape, const Complex* nq, const Complex* nq_mirrored, const Complex* s, Complex* out) {
  for (int y = 0; y < shape.side_y; ++y) {
    const Complex a = nq[y], b = std::conj(nq_mirrored[y == 0 ? 0 : shape.side_y - y]);
    const Complex n = 0.5 * (a + b), difference = 0.5 * (a - b);
    const Complex q(difference.imag(), -difference.real());
    out[y] = {2.0 * (n.real() * q.real() + n.imag() * q.imag()) - 2.0 * std::norm(s[y]), std::norm(n)};
  }
}

/// Column kx = 0 … side/2 of the above, transformed along y.
Grid<Complex> correlated_columns(const Shape& shape, const Grid<Complex>& nq, const Grid<Complex>& s,
                                 Executor& executor) {
  const int half = shape.side_x / 2;
  Grid<Complex> result(half + 1, shape.side_y);
  executor.for_ranges(half + 1, [&](int begin, int end) {
    Dft<double> dft(shape.side_y);
    const auto side = static_cast<std::size_t>(shape.side_y);
    std::vector<Complex> a(side), b(side), c(side), product(side);
    for (int x = begin; x < end; ++x) {
      const int mirrored = x == 0 ? 0 : shape.side_x - x;
      dft.forward(nq.row(x).data(), a.data());
      if (mirrored != x) dft.forward(nq.row(mirrored).data(), b.data());
      dft.forward(s.row(x).data(), c.data());
      combine(shape, a.data(), mirrored != x ? b.data() : a.data(), c.data(), product.data());
      dft.forward(product.data(), result.row(x).data());
    }
  });
  return result;
}

}  // namespace

LatticeShape::LatticeShape(int lattice_rows, int lattice_columns, double reach_cells)
    : rows(lattice_rows), columns(lattice_columns) {
  const auto reach = [&](int size) { return static_cast<int>(std::min(std::floor(reach_cells), size - 1.0)); };
  reach_rows = reach(rows);
  reach_columns = reach(columns);
  side_y = smooth_even_size(rows + reach_rows);
  side_x = smooth_even_size(columns + reach_columns);
}

Grid<Complex> lattice_correlation(const LatticeShape& shape, const LatticeDeposit& deposit, Executor& executor) {
  const Grid<Complex> nq = transformed_rows(shape, deposit.count_square, executor);
  const Grid<Complex> s = transformed_real_rows(shape, deposit.sum, executor);
  return correlated_columns(shape, nq, s, executor);
}

}  // namespace scree::fractal
