// Pair sums on a lattice from autocorrelations: with n points, Σz = s and Σz² = q a cell, the pairs at an offset number
// n⋆n, and their squared differences sum to n⋆q + q⋆n − 2 s⋆s.

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "fractal/annulus_rule.hpp"
#include "fractal/fourier.hpp"
#include "fractal/pair_routes.hpp"

namespace scree::fractal {
namespace {

using Complex = std::complex<double>;
constexpr double kMaxCells = 1 << 25;  // 1.3 GB of transforms
constexpr int kBlock = 8;              // rows or columns gathered together: whole cache lines on the strided side

struct Deposit {
  Grid<Complex> count_square;  ///< n + i q
  Grid<double> sum;            ///< s
};

/// Padded by the reach, so that nothing wraps around.
struct Shape {
  int rows = 0, columns = 0, reach_rows = 0, reach_columns = 0, side_y = 0, side_x = 0;

  Shape(int rows_, int columns_, double reach_cells) : rows(rows_), columns(columns_) {
    const auto reach = [&](int size) { return static_cast<int>(std::min(std::floor(reach_cells), size - 1.0)); };
    reach_rows = reach(rows);
    reach_columns = reach(columns);
    side_y = smooth_even_size(rows + reach_rows);
    side_x = smooth_even_size(columns + reach_columns);
  }
};

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

/// Adds the offsets (y, x), y = 0 … reach, |x| ≤ reach, half a plane, to their annuli.
class OffsetBins {
 public:
  OffsetBins(const Shape& shape, const Annuli& annuli, double cell_m)
      : shape_(shape), annuli_(annuli), rule_(annuli), cell_m_(cell_m), scale_(1.0 / shape.side_x / shape.side_y) {}

  void add_row(int y, const Complex* line, std::vector<PairSums>& sums) const {
    for (int x = y == 0 ? 1 : -shape_.reach_columns; x <= shape_.reach_columns; ++x) {
      const Complex value = line[x < 0 ? x + shape_.side_x : x] * scale_;
      const double pairs = std::round(value.imag());
      if (pairs < 1.0) continue;
      const double dx = x * cell_m_, dy = y * cell_m_;
      const int key = annulus_of(rule_, annuli_.spacing, static_cast<float>(dx), static_cast<float>(dy));
      if (key == annuli_.count) continue;
      auto& sum = sums[static_cast<std::size_t>(key)];
      sum.count += pairs;
      sum.square_m2 += std::max(0.0, value.real());
      sum.log_m += pairs * 0.5 * std::log(dx * dx + dy * dy);
    }
  }

 private:
  const Shape& shape_;
  const Annuli& annuli_;
  AnnulusRule rule_;
  double cell_m_, scale_;
};

StructureFunction correlate(const Shape& shape, const Deposit& deposit, const Annuli& annuli, double cell_m,
                            Executor& executor) {
  const Grid<Complex> nq = transformed_rows(shape, deposit.count_square, executor);
  const Grid<Complex> s = transformed_real_rows(shape, deposit.sum, executor);
  const Grid<Complex> columns = correlated_columns(shape, nq, s, executor);
  const OffsetBins bins(shape, annuli, cell_m);
  const int offsets = shape.reach_rows + 1, blocks = (offsets + kBlock - 1) / kBlock, half = shape.side_x / 2;
  std::vector<std::vector<PairSums>> parts(static_cast<std::size_t>(blocks),
                                           std::vector<PairSums>(static_cast<std::size_t>(annuli.count)));
  executor.for_ranges(blocks, [&](int begin, int end) {
    Dft<double> dft(shape.side_x);
    const auto side = static_cast<std::size_t>(shape.side_x);
    std::vector<Complex> block(side * kBlock), out(side);
    for (int b = begin; b < end; ++b) {
      const int first = b * kBlock, count = std::min(kBlock, offsets - first);
      for (int x = 0; x <= half; ++x)
        for (int k = 0; k < count; ++k) {
          const int y = first + k, mirrored_y = y == 0 ? 0 : shape.side_y - y;
          Complex* line = block.data() + static_cast<std::size_t>(k) * side;
          line[x] = columns(x, y);
          if (x > 0 && x < half) line[shape.side_x - x] = columns(x, mirrored_y);
        }
      for (int k = 0; k < count; ++k) {
        dft.forward(block.data() + static_cast<std::size_t>(k) * side, out.data());
        bins.add_row(first + k, out.data(), parts[static_cast<std::size_t>(b)]);
      }
    }
  });
  StructureFunction result{annuli, std::vector<PairSums>(static_cast<std::size_t>(annuli.count)), false};
  for (const auto& part : parts) add_sums(result.sums, part);
  for (auto& sums : result.sums) sums.abs_m = std::numeric_limits<double>::quiet_NaN();
  return result;
}

Status check_size(double rows, double columns, double reach_cells) {
  const double reach_y = std::min(reach_cells, rows), reach_x = std::min(reach_cells, columns);
  if ((rows + reach_y) * (columns + reach_x) <= kMaxCells) return {};
  return Error{
      ErrorKind::bad_data,
      fmt::format("structure function: expected a lattice of at most {:.0f} cells with its margin, found {:.0f} "
                  "x {:.0f} cells and a margin of {:.0f}; take coarser cells or shorter distances",
                  kMaxCells, rows, columns, reach_cells)};
}

}  // namespace

Result<StructureFunction> lattice_pairs(const PointColumns& points, const Annuli& annuli, double cell_m,
                                        Executor& executor) {
  const auto [x0, x1] = std::minmax_element(points.x_m.begin(), points.x_m.end());
  const auto [y0, y1] = std::minmax_element(points.y_m.begin(), points.y_m.end());
  const double x_min = *x0, y_min = *y0, reach_cells = annuli.outer_m(annuli.count - 1) / cell_m;
  const double columns = std::round((*x1 - x_min) / cell_m) + 1.0, rows = std::round((*y1 - y_min) / cell_m) + 1.0;
  if (Status status = check_size(rows, columns, reach_cells); !status) return status.error();
  const Shape shape(static_cast<int>(rows), static_cast<int>(columns), reach_cells);
  double mean = 0.0;
  for (const float z : points.z_m) mean += z;
  mean /= static_cast<double>(points.size());
  Deposit deposit{{shape.rows, shape.columns}, {shape.rows, shape.columns}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int r = static_cast<int>(std::round((points.y_m[i] - y_min) / cell_m));
    const int c = static_cast<int>(std::round((points.x_m[i] - x_min) / cell_m));
    const double z = points.z_m[i] - mean;
    deposit.count_square(r, c) += Complex{1.0, z * z};
    deposit.sum(r, c) += z;
  }
  return correlate(shape, deposit, annuli, cell_m, executor);
}

Result<StructureFunction> lattice_structure_function(const Grid<float>& height_m, double cell_m, const Annuli& annuli,
                                                     Executor& executor) {
  if (Status status = check_annuli(annuli); !status) return status.error();
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return Error{ErrorKind::usage, fmt::format("structure function: expected a finite cell_m > 0, found {}", cell_m)};
  const double reach_cells = annuli.outer_m(annuli.count - 1) / cell_m;
  if (Status status = check_size(height_m.rows(), height_m.columns(), reach_cells); !status) return status.error();
  double mean = 0.0, known = 0.0;
  for (const float z : height_m)
    if (std::isfinite(z)) mean += z, known += 1.0;
  if (known < 2.0)
    return Error{ErrorKind::bad_data,
                 fmt::format("structure function: expected at least 2 known heights, found {:.0f}", known)};
  mean /= known;
  const Shape shape(height_m.rows(), height_m.columns(), reach_cells);
  Deposit deposit{{shape.rows, shape.columns}, {shape.rows, shape.columns}};
  for (std::size_t i = 0; i < height_m.size(); ++i)
    if (std::isfinite(height_m[i])) {
      const double z = height_m[i] - mean;
      deposit.count_square[i] = {1.0, z * z};
      deposit.sum[i] = z;
    }
  return correlate(shape, deposit, annuli, cell_m, executor);
}

}  // namespace scree::fractal
